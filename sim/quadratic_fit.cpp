#include "sim/quadratic_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace deforma {

namespace {

constexpr double dropped_eigenvalue = 1e-6;  // of the largest: below it the neighbours do not settle the fit

// x, y, z, xx/2, yy/2, zz/2, yz, zx, xy
constexpr std::array<int, 9> all_terms = {0, 1, 2, 3, 4, 5, 6, 7, 8};
constexpr std::array<int, 8> two_layers = {0, 1, 2, 3, 4, 6, 7, 8};
constexpr std::array<int, 5> sheet = {0, 1, 3, 4, 8};
constexpr std::array<int, 2> rope = {0, 3};

Eigen::Matrix<double, 9, 1> nine_terms(const Vec3& X, const Mat3& XX) {
  Eigen::Matrix<double, 9, 1> p;
  p << X, 0.5 * XX(0, 0), 0.5 * XX(1, 1), 0.5 * XX(2, 2), XX(1, 2), XX(2, 0), XX(0, 1);
  return p;
}

constexpr double flat = 1e-20;  // square offset, of the widest, in a direction where neighbours do not extend

// Axes, the thin direction last, of neighbours that all lie on one quadric, given by its nine coefficients: for two
// parallel layers it is the pair of their planes.
Mat3 thin_axes(const QuadraticFit::Terms& quadric) {
  Mat3 second;
  second << quadric[3], quadric[8], quadric[7], quadric[8], quadric[4], quadric[6], quadric[7], quadric[6],
      quadric[5];
  Eigen::SelfAdjointEigenSolver<Mat3> eigen(second);
  Mat3 axes = eigen.eigenvectors();
  if (std::abs(eigen.eigenvalues()[0]) > std::abs(eigen.eigenvalues()[2])) axes.col(0).swap(axes.col(2));
  return axes;
}

// Columns, the widest direction first.
Mat3 principal_axes(const Particles& particles, const Neighborhood& links, std::size_t i) {
  Mat3 A = Mat3::Zero();
  Range row = links.row(i);
  for (Index l = row.begin; l < row.end; ++l) {
    const Vec3 X = particles.rest[links.links[l].j] - particles.rest[i];
    A += static_cast<double>(links.links[l].weight) * X * X.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Mat3>(A).eigenvectors().rowwise().reverse();
}

// Whether the neighbours extend along the first `rank` axes only. Asked of them one by one: the eigenvalues of a flat
// neighbourhood that lies askew are off by the rounding of the largest.
bool extends_no_further(const Particles& particles, const Neighborhood& links, std::size_t i,
                        const Mat3& axes, int rank) {
  double within = 0.0, across = 0.0;
  Range row = links.row(i);
  for (Index l = row.begin; l < row.end; ++l) {
    const Vec3 X = axes.transpose() * (particles.rest[links.links[l].j] - particles.rest[i]);
    within = std::max(within, X.squaredNorm());
    for (int axis = rank; axis < 3; ++axis) across = std::max(across, X[axis] * X[axis]);
  }
  return across <= flat * within;
}

}  // namespace

QuadraticFit::QuadraticFit(const Particles& particles, const Neighborhood& links, std::size_t i, int rank)
    : h_(links.support[i]) {
  Terms unsettled;
  if (fit(particles, links, i, all_terms, &unsettled)) return;
  if (rank == 3) {
    if (unsettled.size() == 0) return;
    axes_ = thin_axes(unsettled);
    fit(particles, links, i, two_layers, nullptr);
    return;
  }
  if (rank == 0) return;
  axes_ = principal_axes(particles, links, i);
  // Offsets across an almost flat sheet would take part in rotations but not in the fit.
  if (!extends_no_further(particles, links, i, axes_, rank)) return;
  fit(particles, links, i, rank == 2 ? std::span<const int>(sheet) : rope, nullptr);
}

bool QuadraticFit::fit(const Particles& particles, const Neighborhood& links, std::size_t i,
                       std::span<const int> chosen, Terms* unsettled) {
  chosen_ = chosen;
  if (links.row(i).size() < chosen_.size()) return false;
  const Square M = moments(particles, links, i);
  // The trace is above the largest eigenvalue, and the norm of the inverse above that of the smallest one: where their
  // product is small enough, and it nearly always is, the eigenvalues need not be found.
  const Eigen::LLT<Square> factor(M);
  if (factor.info() == Eigen::Success) {
    inverse_ = factor.solve(Square::Identity(M.rows(), M.cols()));
    if (inverse_.norm() * M.trace() * dropped_eigenvalue < 0.999) return true;
  }
  return decompose(M, unsettled);
}

QuadraticFit::Square QuadraticFit::moments(const Particles& particles, const Neighborhood& links,
                                           std::size_t i) const {
  const std::size_t count = chosen_.size();
  std::array<std::array<double, 9>, 9> lower{};
  const Range row = links.row(i);
  for (Index l = row.begin; l < row.end; ++l) {
    const Terms p = terms(particles.rest[links.links[l].j] - particles.rest[i]);
    const double* term = p.data();
    for (std::size_t a = 0; a < count; ++a) {
      const double weighted = static_cast<double>(links.links[l].weight) * term[a];
      for (std::size_t b = 0; b <= a; ++b) lower[a][b] += weighted * term[b];
    }
  }
  Square M(count, count);
  for (Eigen::Index a = 0; a < M.rows(); ++a)
    for (Eigen::Index b = 0; b <= a; ++b)
      M(a, b) = M(b, a) = lower[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  return M;
}

bool QuadraticFit::decompose(const Square& M, Terms* unsettled) {
  const Eigen::SelfAdjointEigenSolver<Square> eigen(M);
  const auto& values = eigen.eigenvalues();  // ascending
  if (!(values[0] > dropped_eigenvalue * values[M.rows() - 1])) {
    if (unsettled) *unsettled = eigen.eigenvectors().col(0);
    inverse_.resize(0, 0);
    return false;
  }
  const Square scaled = eigen.eigenvectors() * values.cwiseInverse().asDiagonal();
  inverse_ = scaled * eigen.eigenvectors().transpose();
  return true;
}

QuadraticFit::Terms QuadraticFit::terms(const Vec3& offset) const {
  const Vec3 X = axes_.transpose() * offset / h_;
  const std::array<double, 9> all = {X.x(),
                                     X.y(),
                                     X.z(),
                                     0.5 * X.x() * X.x(),
                                     0.5 * X.y() * X.y(),
                                     0.5 * X.z() * X.z(),
                                     X.y() * X.z(),
                                     X.z() * X.x(),
                                     X.x() * X.y()};
  Terms chosen(chosen_.size());
  for (std::size_t k = 0; k < chosen_.size(); ++k)
    chosen[static_cast<Eigen::Index>(k)] = all[static_cast<std::size_t>(chosen_[k])];
  return chosen;
}

Vec3 QuadraticFit::gradient_of(const Terms& terms) const {
  Vec3 local = Vec3::Zero();
  const auto count = static_cast<std::size_t>(terms.size());
  for (std::size_t k = 0; k < count && chosen_[k] < 3; ++k) {  // the gradient's terms come first
    const double* row = inverse_.data() + k * count;
    double sum = 0.0;
    for (std::size_t t = 0; t < count; ++t) sum += row[t] * terms.data()[t];
    local[chosen_[k]] = sum;
  }
  return axes_ * local / h_;
}

QuadraticFit::Terms QuadraticFit::integrated(const Cell& cell) const {
  const Vec3 first = axes_.transpose() * cell.first / h_;
  const Mat3 second = axes_.transpose() * cell.second * axes_ / (h_ * h_);
  return nine_terms(first, second)(chosen_);
}

std::vector<Index> reverse_links(const Neighborhood& links) {
  std::vector<Index> reverse(links.links.size());
  // Rows are ascending in j and links symmetric: rows taken in order meet the links of every other row in order, too.
  std::vector<Index> next(links.start.begin(), links.start.end() - 1);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) reverse[l] = next[links.links[l].j]++;
  }
  return reverse;
}

}  // namespace deforma
