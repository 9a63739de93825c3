#include "pipeline/validation_reference.hpp"

#include <cmath>
#include <numbers>

namespace deforma::reference {

namespace {

double shear_modulus(double young, double poisson) { return young / (2.0 * (1.0 + poisson)); }

double bending_stiffness(double width, double young) { return young * std::pow(width, 4) / 12.0; }

double shear_stiffness(double width, double young, double poisson) {
  return shear_factor(poisson) * shear_modulus(young, poisson) * width * width;
}

/// An end of the elastica that starts with curvature `curvature`: lengths over L.
struct Tip {
  double moment;      ///< curvature at the tip: zero at the solution
  double deflection;  ///< v/L
};

Tip integrate_elastica(double load, double curvature) {
  constexpr int steps = 2000;
  constexpr double h = 1.0 / steps;
  double theta = 0.0, v = 0.0;
  for (int i = 0; i < steps; ++i) {  // Runge-Kutta of theta' = k, k' = -load cos theta, v' = sin theta
    double t1 = curvature, k1 = -load * std::cos(theta), v1 = std::sin(theta);
    double t2 = curvature + 0.5 * h * k1, a2 = theta + 0.5 * h * t1;
    double k2 = -load * std::cos(a2), v2 = std::sin(a2);
    double t3 = curvature + 0.5 * h * k2, a3 = theta + 0.5 * h * t2;
    double k3 = -load * std::cos(a3), v3 = std::sin(a3);
    double t4 = curvature + h * k3, a4 = theta + h * t3;
    double k4 = -load * std::cos(a4), v4 = std::sin(a4);
    theta += h / 6.0 * (t1 + 2.0 * t2 + 2.0 * t3 + t4);
    curvature += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
  }
  return {curvature, v};
}

}  // namespace

double shear_factor(double poisson) { return 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson); }

double end_loaded_tip(double force, double length, double width, double young, double poisson) {
  return force * std::pow(length, 3) / (3.0 * bending_stiffness(width, young)) +
         force * length / shear_stiffness(width, young, poisson);
}

double sag_under_weight(double weight_per_length, double length, double width, double young, double poisson) {
  return weight_per_length * std::pow(length, 4) / (8.0 * bending_stiffness(width, young)) +
         weight_per_length * length * length / (2.0 * shear_stiffness(width, young, poisson));
}

double square_torsion_constant() {
  constexpr double pi = std::numbers::pi;
  double sum = 0.0;
  for (int k = 1; k < 200; k += 2) sum += std::tanh(0.5 * k * pi) / std::pow(k, 5);
  return (1.0 - 192.0 / std::pow(pi, 5) * sum) / 3.0;
}

double elastica_tip(double load) {
  // The tip's curvature grows with the root's, from below zero (too little) up: bisection. Energy bounds the root's
  // curvature by sqrt(2 load), the small-deflection one is load.
  double low = 0.0, high = std::sqrt(2.0 * load) + 1e-9;
  for (int i = 0; i < 60; ++i) {
    double middle = 0.5 * (low + high);
    (integrate_elastica(load, middle).moment < 0.0 ? low : high) = middle;
  }
  return integrate_elastica(load, low).deflection;
}

}  // namespace deforma::reference
