#pragma once

// The loops over strain and stress: each particle's is its own, so four are worked on at once.
#include "sim/inner_loops/four.hpp"

namespace deforma {
namespace {

/// The same matrix of four particles, or of a last one to three: one component of all in each vector.
struct Matrices {
  Four at[9];
};
/// Calls visit(first, count) for every four particles and for those left.
template <typename Visit>
DEFORMA_INLINE void by_fours(std::size_t count, const Visit& visit) {
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) visit(k, std::size_t{4});
  if (k != count) visit(k, count - k);
}
DEFORMA_INLINE Matrices load_matrices(const double* from, std::size_t count) {
  double few[36];
  if (count < 4) {  // the last one again for those that are not there
    for (std::size_t k = 0; k < 36; ++k) few[k] = from[9 * (k / 9 < count ? k / 9 : count - 1) + k % 9];
    from = few;
  }
  Matrices m;
  for (int half = 0; half < 2; ++half) {
    for (int k = 0; k < 4; ++k) m.at[4 * half + k] = load_unaligned(from + 9 * k + 4 * half);
    transpose(m.at[4 * half], m.at[4 * half + 1], m.at[4 * half + 2], m.at[4 * half + 3]);
  }
  m.at[8] = Four{from[8], from[17], from[26], from[35]};
  return m;
}
DEFORMA_INLINE void store_matrices(double* to, Matrices m, std::size_t count) {
  double few[36];
  double* const all = count < 4 ? few : to;
  for (int half = 0; half < 2; ++half) {
    transpose(m.at[4 * half], m.at[4 * half + 1], m.at[4 * half + 2], m.at[4 * half + 3]);
    for (int k = 0; k < 4; ++k) store(all + 9 * k + 4 * half, m.at[4 * half + k]);
  }
  for (int k = 0; k < 4; ++k) all[9 * k + 8] = m.at[8][k];
  if (count < 4)
    for (std::size_t k = 0; k < 9 * count; ++k) to[k] = few[k];
}
DEFORMA_INLINE Four squared_norm(const Matrices& m) {
  Four sum = m.at[0] * m.at[0];
  for (int k = 1; k < 9; ++k) sum += m.at[k] * m.at[k];
  return sum;
}
DEFORMA_INLINE Matrices cofactors(const Matrices& F) {
  Matrices C;
  for (int c = 0; c < 3; ++c) {  // column c is the cross product of the two that follow it
    const Four *const a = F.at + 3 * ((c + 1) % 3), *const b = F.at + 3 * ((c + 2) % 3);
    C.at[3 * c] = a[1] * b[2] - a[2] * b[1];
    C.at[3 * c + 1] = a[2] * b[0] - a[0] * b[2];
    C.at[3 * c + 2] = a[0] * b[1] - a[1] * b[0];
  }
  return C;
}
DEFORMA_INLINE Four determinants(const Matrices& F, const Matrices& C) {
  return (F.at[0] * C.at[0] + F.at[1] * C.at[1]) + F.at[2] * C.at[2];
}
DEFORMA_INLINE Four larger(Four a, Four b) { return a > b ? a : b; }
DEFORMA_INLINE double largest(Four x, double known) {
  for (int k = 0; k < 4; ++k) known = x[k] > known ? x[k] : known;
  return known;
}

void survey(const double* F, const double* F_before, std::size_t count, double exploded, double* stiffening,
            double* change) {
  const Four none{}, one = all(1.0), half = all(0.5), limit = all(exploded * exploded),
                     infinite = all(__builtin_inf());
  Four most_stiffening{}, most_change{};
  by_fours(
      count, [&](std::size_t first, std::size_t some) __attribute__((always_inline)) {
        for (std::size_t k = 0; k != 5; ++k) ask_to_write(F_before + 9 * (first + next_block) + 8 * k);
        const Matrices now = load_matrices(F + 9 * first, some);
        Matrices moved = load_matrices(F_before + 9 * first, some);
        for (int k = 0; k < 9; ++k) moved.at[k] = now.at[k] - moved.at[k];
        const Four squared = squared_norm(now);
        const Matrices C = cofactors(now);
        const Four off = determinants(now, C) - one;
        Four root;
        for (int k = 0; k < 4; ++k) root[k] = __builtin_sqrt(squared[k]);
        const Four stiff = ((half + squared) + squared_norm(C)) + larger(off, -off) * root;
        const auto fine = squared < limit;  // not so where some F is not finite
        most_stiffening = larger(fine ? stiff : infinite, most_stiffening);
        most_change = larger(fine ? squared_norm(moved) / larger(squared, one) : none, most_change);
      });
  *stiffening = largest(most_stiffening, *stiffening);
  *change = largest(most_change, *change);
}

void neo_hookean(double lambda, double mu, const double* F, std::size_t count, double* P) {
  const Four shear = all(mu), both = all(lambda + mu), one = all(1.0);
  by_fours(
      count, [&](std::size_t first, std::size_t some) __attribute__((always_inline)) {
        const Matrices f = load_matrices(F + 9 * first, some);
        Matrices p = load_matrices(P + 9 * first, some);
        const Matrices C = cofactors(f);
        const Four pressure = both * (determinants(f, C) - one) - shear;
        for (int k = 0; k < 9; ++k) p.at[k] += shear * f.at[k] + pressure * C.at[k];
        store_matrices(P + 9 * first, p, some);
      });
}

}  // namespace
}  // namespace deforma
