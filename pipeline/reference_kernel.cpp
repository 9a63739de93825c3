#include "pipeline/reference_kernel.hpp"

// Compiled twice, the second time with machine flags and another name for the result; all else is local to each.
#ifndef DEFORMA_REFERENCE_KERNEL
#define DEFORMA_REFERENCE_KERNEL reference_kernel_portable
#endif

namespace deforma {

namespace {

// Inversion-safe neo-Hookean: P = mu F + ((lambda + mu)(J - 1) - mu) cof F.
void weigh_stress(const double* F, double lambda, double mu, double weight, double* carried) {
  const double C[9] = {F[4] * F[8] - F[5] * F[7], F[5] * F[6] - F[3] * F[8], F[3] * F[7] - F[4] * F[6],
                       F[7] * F[2] - F[8] * F[1], F[8] * F[0] - F[6] * F[2], F[6] * F[1] - F[7] * F[0],
                       F[1] * F[5] - F[2] * F[4], F[2] * F[3] - F[0] * F[5], F[0] * F[4] - F[1] * F[3]};
  const double J = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
  const double p = (lambda + mu) * (J - 1.0) - mu;
  for (int k = 0; k < 9; ++k) carried[k] = weight * (mu * F[k] + p * C[k]);
}

void find_stress(const ReferenceArrays& body) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    const double* own = body.u + 3 * i;
    double G[9] = {};
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l) {
      const double* other = body.u + 3 * std::size_t{body.j[l]};
      const double* g = body.g + 3 * std::size_t{l};
      const double x = other[0] - own[0], y = other[1] - own[1], z = other[2] - own[2];
      for (int k = 0; k < 3; ++k) {
        G[3 * k] += x * g[k];
        G[3 * k + 1] += y * g[k];
        G[3 * k + 2] += z * g[k];
      }
    }
    double F[9];
    for (int k = 0; k < 9; ++k) body.gradient[9 * i + k] = F[k] = G[k];
    F[0] += 1.0;
    F[4] += 1.0;
    F[8] += 1.0;
    weigh_stress(F, body.lambda, body.mu, body.weight[i], body.carried + 9 * i);
  }
}

// e_ij = u_ij - (grad u_i + grad u_j)/2 X_ij pulls at both particles and bends their stress.
void add_trapezoid(const ReferenceArrays& body) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    const double* G = body.gradient + 9 * i;
    const double* u = body.u + 3 * i;
    const double* X = body.rest + 3 * i;
    double sum[3] = {}, moment[9] = {};
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l) {
      const std::size_t j = body.j[l];
      const double* H = body.gradient + 9 * j;
      double arm[3], f[3];
      for (int k = 0; k < 3; ++k) arm[k] = body.rest[3 * j + k] - X[k];
      for (int k = 0; k < 3; ++k) {
        const double fitted =
            (G[k] + H[k]) * arm[0] + (G[3 + k] + H[3 + k]) * arm[1] + (G[6 + k] + H[6 + k]) * arm[2];
        f[k] = body.c[l] * (body.u[3 * j + k] - u[k] - 0.5 * fitted);
        sum[k] += f[k];
      }
      for (int m = 0; m < 3; ++m)
        for (int k = 0; k < 3; ++k) moment[3 * m + k] += f[k] * arm[m];
    }
    for (int k = 0; k < 3; ++k) body.force[3 * i + k] += sum[k];
    for (int k = 0; k < 9; ++k) body.carried[9 * i + k] -= 0.5 * moment[k];
  }
}

template <bool own_residual>
void scatter_force(const ReferenceArrays& body) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    const double* T = body.carried + 9 * i;
    const double* G = body.gradient + 9 * i;
    const double* u = body.u + 3 * i;
    const double* X = body.rest + 3 * i;
    double sum[3] = {};
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l) {
      const std::size_t j = 3 * std::size_t{body.j[l]};
      const double* g = body.g + 3 * std::size_t{l};
      double* reaction = body.force + j;
      double f[3];
      for (int k = 0; k < 3; ++k) f[k] = T[k] * g[0] + T[3 + k] * g[1] + T[6 + k] * g[2];
      if constexpr (own_residual) {
        const double x = body.rest[j] - X[0], y = body.rest[j + 1] - X[1], z = body.rest[j + 2] - X[2];
        for (int k = 0; k < 3; ++k)
          f[k] -= body.c[l] * (G[k] * x + G[3 + k] * y + G[6 + k] * z - (body.u[j + k] - u[k]));
      }
      for (int k = 0; k < 3; ++k) {
        sum[k] += f[k];
        reaction[k] -= f[k];
      }
    }
    for (int k = 0; k < 3; ++k) body.force[3 * i + k] += sum[k];
  }
}

void find_force(const ReferenceArrays& body) {
  find_stress(body);
  for (std::size_t k = 0; k < 3 * body.particles; ++k) body.force[k] = 0.0;
  if (body.residual == ReferenceResidual::trapezoid) add_trapezoid(body);
  if (body.residual == ReferenceResidual::own_fit)
    scatter_force<true>(body);
  else
    scatter_force<false>(body);
}

void integrate(const ReferenceArrays& body, double dt) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    const double push = dt / body.mass[i];
    for (int k = 0; k < 3; ++k) {
      body.v[3 * i + k] += push * body.force[3 * i + k];
      body.u[3 * i + k] += dt * body.v[3 * i + k];
    }
  }
}

}  // namespace

const ReferenceKernel DEFORMA_REFERENCE_KERNEL = {find_force, integrate};

}  // namespace deforma
