#pragma once

// The loops over neighbours.
#include "sim/inner_loops/four.hpp"

namespace deforma {
namespace {

/// Three vectors that are summed over a row: its even and its odd links apart.
struct Three {
  Four x{}, y{}, z{};
};
DEFORMA_INLINE void add(Three& to, const Three& other) {
  to.x += other.x;
  to.y += other.y;
  to.z += other.z;
}
DEFORMA_INLINE void store(double* to, const Three& sum) {
  store(to, sum.x);
  store(to + 4, sum.y);
  store(to + 8, sum.z);
}
/// Of Q, which is the identity where there are none.
DEFORMA_INLINE Four projector_column(const double* projectors, std::size_t i, int c) {
  constexpr Four unit[3] = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
  return projectors ? load_three(projectors + 9 * i + 3 * c) : unit[c];
}
/// Asks the memory for what a row a little further on will need: a hint, which may name any address. The links of
/// short rows are among it, which the processor's own foresight loses among all that is gathered beside them.
template <typename RowLink>
class Foresight {
 public:
  explicit Foresight(const Rows<RowLink>& rows) : rows_(rows) {
    if (rows.ahead && rows.end > rows.begin && sizeof(RowLink) <= short_link)
      lines_ =
          (rows.start[rows.end] - rows.start[rows.begin]) * sizeof(RowLink) / (rows.end - rows.begin) / line +
          1;
  }

  /// @param ask called with a particle that will be gathered from
  template <typename Ask>
  DEFORMA_INLINE void look(std::size_t i, const Ask& ask) const {
    if (!rows_.ahead) return;
    for (const std::uint32_t j : rows_.ahead[i].j) ask(j);
    // Links are looked at once a gather: they are not to take the cache from what is gathered again.
    const auto links = reinterpret_cast<std::uintptr_t>(rows_.links + rows_.start[i]) + early;
    for (std::size_t k = 0; k != lines_; ++k)
      __builtin_prefetch(reinterpret_cast<const void*>(links + k * line), 0, 0);
  }

 private:
  static constexpr std::size_t line = 64, early = 4096, short_link = 8;  // bytes

  const Rows<RowLink>& rows_;
  std::size_t lines_ = 0;  // of the links of a row, on the mean
};
DEFORMA_INLINE void ask_for(const Carrier& carrier) {
  __builtin_prefetch(carrier.head);
  __builtin_prefetch(carrier.line[1]);
}

DEFORMA_INLINE void turn_into_columns(Three& rows) {
  Four none{};
  transpose(rows.x, rows.y, rows.z, none);
}
/// Calls visit(link, sum) for every link of a row.
template <typename RowLink, typename Visit>
DEFORMA_INLINE Three over_row(const Rows<RowLink>& rows, std::size_t i, const Visit& visit) {
  Three even, odd;
  const RowLink* link = rows.links + rows.start[i];
  const RowLink* const end = rows.links + rows.start[i + 1];
  for (; end - link >= 2; link += 2) {
    visit(link[0], even);
    visit(link[1], odd);
  }
  if (link != end) visit(link[0], even);
  add(even, odd);
  return even;
}

void linear_gradient(const Rows<Link>& rows, const Place* places, const double* inverses, const double* field,
                     const double* projectors, double* F) {
  const Foresight<Link> foresight(rows);
  for (std::size_t i = rows.begin; i != rows.end; ++i, F += 9) {
    foresight.look(
        i, [&](std::size_t j) __attribute__((always_inline)) {
          __builtin_prefetch(places + j);
          __builtin_prefetch(field + 3 * j);
        });
    const Four X = load(places[i].X);
    const Four ux = all_kept(field[3 * i]), uy = all_kept(field[3 * i + 1]), uz = all_kept(field[3 * i + 2]);
    Three sum = over_row(
        rows, i, [&](const Link& link, Three& row) __attribute__((always_inline)) {
          const std::size_t j = link.j;
          const Four WX = (load(places[j].X) - X) * all(link.weight);
          const double* const u = field + 3 * j;
          row.x += (all(u[0]) - ux) * WX;  // eq 8
          row.y += (all(u[1]) - uy) * WX;
          row.z += (all(u[2]) - uz) * WX;
        });
    turn_into_columns(sum);
    const double* const inverse = inverses + 9 * i;
    for (int c = 0; c < 3; ++c)  // eq 7
      store_three(F + 3 * c, projector_column(projectors, i, c) +
                                 ((sum.x * all(inverse[3 * c]) + sum.y * all(inverse[3 * c + 1])) +
                                  sum.z * all(inverse[3 * c + 2])));
  }
}

void quadratic_gradient(const Rows<GradientLink>& rows, const double* field, const double* projectors,
                        double* F) {
  const Foresight<GradientLink> foresight(rows);
  for (std::size_t i = rows.begin; i != rows.end; ++i, F += 9) {
    foresight.look(
        i, [&](std::size_t j) __attribute__((always_inline)) { __builtin_prefetch(field + 3 * j); });
    const Four ux = all_kept(field[3 * i]), uy = all_kept(field[3 * i + 1]), uz = all_kept(field[3 * i + 2]);
    Three sum = over_row(
        rows, i, [&](const GradientLink& link, Three& row) __attribute__((always_inline)) {
          const Four g = load_unaligned(link.g);  // the fourth is not used
          const double* const u = field + 3 * std::size_t{link.link.j};
          row.x += (all(u[0]) - ux) * g;
          row.y += (all(u[1]) - uy) * g;
          row.z += (all(u[2]) - uz) * g;
        });
    turn_into_columns(sum);
    store_three(F, projector_column(projectors, i, 0) + sum.x);
    store_three(F + 3, projector_column(projectors, i, 1) + sum.y);
    store_three(F + 6, projector_column(projectors, i, 2) + sum.z);
  }
}

void linear_carry(const InnerLoops::Stressed& from, std::size_t count, Carrier* carriers) {
  for (std::size_t k = 0; k != count; ++k) {
    const double* const inverse = from.inverses + 9 * k;
    const double* const P = from.stresses + 9 * k;
    const Four w = all(from.weights[k]);
    const Four px = load_three(P) * w, py = load_three(P + 3) * w, pz = load_three(P + 6) * w;
    Four columns[3];
    for (int c = 0; c < 3; ++c)  // P inverse^T
      columns[c] = (px * all(inverse[c]) + py * all(inverse[3 + c])) + pz * all(inverse[6 + c]);
    Four head = load(from.places[k].X);
    if (from.stiffness) {
      const Four s = all(from.stiffness[k]);
      for (int c = 0; c < 3; ++c)
        columns[c] -= s * (load_three(from.F + 9 * k + 3 * c) - projector_column(from.projectors, k, c));
      head[3] = from.stiffness[k];
    }
    Carrier& carrier = carriers[k];
    ask_to_write(carriers[k + next_block].head);
    ask_to_write(carriers[k + next_block].line[1]);
    store(carrier.head, head);
    Four u = load_three(from.field + 3 * k);
    transpose(columns[0], columns[1], columns[2], u);  // three rows, each with its component of u
    for (int r = 0; r < 3; ++r) store(carrier.line[r], columns[r]);
  }
}

void linear_force(const Rows<Link>& rows, const Carrier* carriers, double* force) {
  const Four turn = {1.0, 1.0, 1.0, -1.0};
  const Foresight<Link> foresight(rows);
  for (std::size_t i = rows.begin; i != rows.end; ++i, force += 3) {
    foresight.look(
        i, [&](std::size_t j) __attribute__((always_inline)) { ask_for(carriers[j]); });
    const Carrier& own = carriers[i];
    // With the fourth turned, one difference gives X_ij and s_i + s_j, one sum B_i + B_j and u_ij: so the pair's two
    // forces are exactly opposite.
    const Four head = load(own.head) * turn;
    const Four bx = load(own.line[0]) * turn, by = load(own.line[1]) * turn, bz = load(own.line[2]) * turn;
    const Three sum = over_row(
        rows, i, [&](const Link& link, Three& row) __attribute__((always_inline)) {
          const Carrier& other = carriers[link.j];
          const Four pair = (load(other.head) - head) * all(link.weight);
          row.x += (load(other.line[0]) + bx) * pair;  // eq 17 and its reaction
          row.y += (load(other.line[1]) + by) * pair;
          row.z += (load(other.line[2]) + bz) * pair;
        });
    force[0] += total(sum.x);
    force[1] += total(sum.y);
    force[2] += total(sum.z);
  }
}

void quadratic_residual(const Rows<Link>& rows, const Carrier* carriers, double* force, double* moments) {
  const Four turn = {1.0, 1.0, 1.0, -1.0}, half = all(0.5);
  const Foresight<Link> foresight(rows);
  for (std::size_t i = rows.begin; i != rows.end; ++i, force += 3, moments += 12) {
    foresight.look(
        i, [&](std::size_t j) __attribute__((always_inline)) { ask_for(carriers[j]); });
    const Carrier& own = carriers[i];
    const Four head = load(own.head) * turn;
    const Four gx = load(own.line[0]), gy = load(own.line[1]), gz = load(own.line[2]);
    const Four X = all(own.line[0][3]), Y = all(own.line[1][3]), Z = all(own.line[2][3]);
    const Four s = all(own.head[3]);
    Four even{}, odd{};
    Three even_moment, odd_moment;
    const auto visit = [&](const Link& link, Four& sum, Three& moment) __attribute__((always_inline)) {
      const Carrier& other = carriers[link.j];
      const Four x = all(other.line[0][3]) - X, y = all(other.line[1][3]) - Y, z = all(other.line[2][3]) - Z;
      const Four bent =
          (load(other.line[0]) + gx) * x + (load(other.line[1]) + gy) * y + (load(other.line[2]) + gz) * z;
      const Four e = (load(other.head) - head) - half * bent;
      const Four f = ((all(other.head[3]) + s) * all(link.weight)) * e;
      sum += f;
      moment.x += f * x;
      moment.y += f * y;
      moment.z += f * z;
    };
    const Link* link = rows.links + rows.start[i];
    const Link* const end = rows.links + rows.start[i + 1];
    for (; end - link >= 2; link += 2) {
      visit(link[0], even, even_moment);
      visit(link[1], odd, odd_moment);
    }
    if (link != end) visit(link[0], even, even_moment);
    even += odd;
    add(even_moment, odd_moment);
    for (int axis = 0; axis < 3; ++axis) force[axis] += even[axis];
    store(moments, even_moment);
  }
}

void quadratic_force(const Rows<GradientLink>& rows, const Carrier* carriers, double* force) {
  const Foresight<GradientLink> foresight(rows);
  for (std::size_t i = rows.begin; i != rows.end; ++i, force += 3) {
    foresight.look(
        i, [&](std::size_t j) __attribute__((always_inline)) { ask_for(carriers[j]); });
    const Three sum = over_row(
        rows, i, [&](const GradientLink& link, Three& row) __attribute__((always_inline)) {
          const Carrier& other = carriers[link.link.j];
          const Four g = load_unaligned(link.g);  // the fourth is not used
          row.x += load(other.line[0]) * g;
          row.y += load(other.line[1]) * g;
          row.z += load(other.line[2]) * g;
        });
    force[0] -= (sum.x[0] + sum.x[1]) + sum.x[2];
    force[1] -= (sum.y[0] + sum.y[1]) + sum.y[2];
    force[2] -= (sum.z[0] + sum.z[1]) + sum.z[2];
  }
}

}  // namespace
}  // namespace deforma
