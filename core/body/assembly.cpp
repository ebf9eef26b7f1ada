// SPDX-License-Identifier: Apache-2.0
#include "body/assembly.hpp"

#include <algorithm>
#include <vector>

#include "body/element.hpp"
#include "body/node_elements.hpp"
#include "body/pools.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fem {
namespace {

void add_element(const Problem& problem, const std::array<Index, 4>& corners,
                 const ElementMatrix& k, std::vector<Eigen::Triplet<double, Index>>& triplets) {
  std::array<Index, 12> dofs;
  for (int i = 0; i < 12; ++i) dofs[i] = problem.dof(corners[i / 3], i % 3);
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      if (dofs[j] == kNone || dofs[i] < dofs[j]) continue;  // kNone < every dof
      triplets.emplace_back(dofs[i], dofs[j], k(i, j));
    }
  }
}

/// Where the entries of the lower triangle lie: below a node's own unknowns those of the nodes
/// after it that share an element with it, in order, for unknowns are numbered by node and axis.
class LowerEntries {
 public:
  explicit LowerEntries(const Problem& problem);
  /// A matrix of all entries, each 0.
  [[nodiscard]] linear_algebra::SparseMatrix zero() const;
  /// To the values of such a matrix.
  void add(const std::array<Index, 4>& corners, const ElementMatrix& k, double* values) const;

 private:
  /// A node after another, and where its rows begin below the unknowns of that.
  struct After {
    Index node, row;
  };
  [[nodiscard]] std::span<const After> after(Index node) const {
    return std::span(after_).subspan(
        begin_[static_cast<std::size_t>(node)],
        begin_[static_cast<std::size_t>(node) + 1] - begin_[static_cast<std::size_t>(node)]);
  }
  /// How many unknowns a node has before an axis.
  [[nodiscard]] Index unknowns(Index node, int axis = 3) const {
    Index count = 0;
    for (int a = 0; a < axis; ++a) count += problem_.dof(node, a) != kNone;
    return count;
  }

  const Problem& problem_;
  std::vector<std::size_t> begin_;  // shape (nodes + 1), in after_
  std::vector<After> after_;
  std::vector<Index> columns_;  // shape (unknowns + 1): where each one's entries begin
};

LowerEntries::LowerEntries(const Problem& problem) : problem_(problem) {
  const NodeElements around(problem.mesh());
  begin_.reserve(problem.mesh().nodes.size() + 1);
  begin_.push_back(0);
  columns_.reserve(static_cast<std::size_t>(problem.dof_count()) + 1);
  columns_.push_back(0);
  std::vector<Index> found, seen_by(problem.mesh().nodes.size(), kNone);
  for (Index node = 0; node < problem.node_count(); ++node) {
    found.clear();
    for (Index e : around.of(node)) {
      for (Index other : problem.mesh().tets[static_cast<std::size_t>(e)]) {
        Index& by = seen_by[static_cast<std::size_t>(other)];
        if (other <= node || by == node) continue;
        by = node;
        found.push_back(other);
      }
    }
    std::sort(found.begin(), found.end());
    Index row = 0;
    for (Index other : found) {
      after_.push_back({other, row});
      row += unknowns(other);
    }
    begin_.push_back(after_.size());
    for (Index own = unknowns(node); own > 0; --own)
      columns_.push_back(columns_.back() + own + row);
  }
}

linear_algebra::SparseMatrix LowerEntries::zero() const {
  linear_algebra::SparseMatrix matrix(problem_.dof_count(), problem_.dof_count());
  matrix.resizeNonZeros(columns_.back());
  std::copy(columns_.begin(), columns_.end(), matrix.outerIndexPtr());
  std::fill_n(matrix.valuePtr(), columns_.back(), 0.0);
  Index* row = matrix.innerIndexPtr();
  const auto put = [&](Index node, int first) {
    for (int axis = first; axis < 3; ++axis) {
      if (problem_.dof(node, axis) != kNone) *row++ = problem_.dof(node, axis);
    }
  };
  for (Index node = 0; node < problem_.node_count(); ++node) {
    for (int axis = 0; axis < 3; ++axis) {
      if (problem_.dof(node, axis) == kNone) continue;
      put(node, axis);
      for (const After& other : after(node)) put(other.node, 0);
    }
  }
  return matrix;
}

void LowerEntries::add(const std::array<Index, 4>& corners, const ElementMatrix& k,
                       double* values) const {
  for (int a = 0; a < 4; ++a) {
    const Index node = corners[static_cast<std::size_t>(a)], own = unknowns(node);
    for (int b = 0; b < 4; ++b) {
      const Index other = corners[static_cast<std::size_t>(b)];
      if (other < node) continue;
      const auto at = std::ranges::lower_bound(after(node), other, {}, &After::node);
      for (int j = 0; j < 3; ++j) {
        const Index column = problem_.dof(node, j);
        if (column == kNone) continue;
        double* to = values + columns_[static_cast<std::size_t>(column)];
        if (other != node) to += own - unknowns(node, j) + at->row;
        for (int i = other == node ? j : 0; i < 3; ++i) {
          if (problem_.dof(other, i) != kNone) *to++ += k(3 * b + i, 3 * a + j);
        }
      }
    }
  }
}

}  // namespace

linear_algebra::SparseMatrix assemble_elements(
    const Problem& problem, const std::function<ElementMatrix(Index)>& matrix_of) {
  const LowerEntries entries(problem);
  linear_algebra::SparseMatrix matrix = entries.zero();
  for (Index e = 0; e < problem.tet_count(); ++e) {
    entries.add(problem.mesh().tets[e], matrix_of(e), matrix.valuePtr());
  }
  // Of a column the diagonal is the first entry.
  for (Index dof : problem.anchored_dofs()) {
    matrix.valuePtr()[matrix.outerIndexPtr()[dof]] += problem.anchor_stiffness();
  }
  return matrix;
}

linear_algebra::SparseMatrix assemble_lower(const Problem& problem, std::span<const double> scale,
                                            const Pools* pools) {
  linear_algebra::SparseMatrix lower = assemble_elements(problem, [&](Index e) {
    ElementMatrix k = element_stiffness(problem, e);
    if (!scale.empty()) k *= scale[e];
    return k;
  });
  if (problem.pools()) lower += assemble_pressure(problem, scale, pools);
  return lower;
}

linear_algebra::SparseMatrix assemble_forms(const Problem& problem, std::span<const Form> forms) {
  std::vector<Eigen::Triplet<double, Index>> triplets;
  for (const Form& form : forms) {
    const ElementMatrix k = form.share * element_stiffness(form.shape, elasticity(form.law));
    add_element(problem, form.corners, k, triplets);
  }
  linear_algebra::SparseMatrix matrix(problem.dof_count(), problem.dof_count());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

void apply_stiffness(const Problem& problem, std::span<const double> scale,
                     std::span<const double> u, std::span<double> y, const Pools* pools) {
  std::fill(y.begin(), y.end(), 0.0);
  const StressField field(problem, scale, u, pools);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const TetShape& shape = problem.shape(e);
    const Voigt s = field.of(e);
    const double weight = shape.volume * (scale.empty() ? 1.0 : scale[e]);
    const Eigen::Matrix<double, 3, 4> force = weight * (tensor(s) * shape.gradient);
    for (int a = 0; a < 4; ++a) {
      const Index n = problem.mesh().tets[e][a];
      for (int axis = 0; axis < 3; ++axis) y[3 * n + axis] += force(axis, a);
    }
  }
}

void scatter(const Problem& problem, std::span<const double> unknowns, std::span<double> nodal) {
  const auto dofs = problem.dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    nodal[i] = dofs[i] == kNone ? 0.0 : unknowns[dofs[i]];
  }
}

void gather(const Problem& problem, std::span<const double> nodal, std::span<double> unknowns) {
  const auto dofs = problem.dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    if (dofs[i] != kNone) unknowns[dofs[i]] = nodal[i];
  }
}

}  // namespace sunder::fem
