// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/supernodes.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>

namespace sunder::linear_algebra {
namespace {

// Wider panels are split: their own triangle, half of it zeros, and what only one thread can do
// with it, grow with the square.
constexpr Index kWidest = 256;

using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index>;

std::vector<Index> minimum_degree(const SparseMatrix& lower) {
  SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  Permutation order;  // column i of the result is unknown order[i]
  Eigen::AMDOrdering<Index>()(full, order);
  std::vector<Index> place(static_cast<std::size_t>(lower.rows()));
  for (Index i = 0; i < static_cast<Index>(place.size()); ++i) place[order.indices()[i]] = i;
  return place;
}

/// Rows of the upper triangle, column by column: the transpose of `lower` without values.
struct UpperPattern {
  std::vector<std::size_t> begin;
  std::vector<Index> row;
};

UpperPattern upper_pattern(const SparseMatrix& lower) {
  const auto n = static_cast<std::size_t>(lower.rows());
  UpperPattern upper;
  upper.begin.assign(n + 1, 0);
  upper.row.resize(static_cast<std::size_t>(lower.nonZeros()));
  for (Index p = 0; p < lower.nonZeros(); ++p) ++upper.begin[lower.innerIndexPtr()[p] + 1];
  for (std::size_t i = 0; i < n; ++i) upper.begin[i + 1] += upper.begin[i];
  std::vector<std::size_t> at(upper.begin.begin(), upper.begin.end() - 1);
  for (Index j = 0; j < lower.cols(); ++j) {
    for (SparseMatrix::InnerIterator it(lower, j); it; ++it) upper.row[at[it.row()]++] = j;
  }
  return upper;
}

/// Elimination tree by path compression (Liu 1990).
std::vector<Index> elimination_tree(const UpperPattern& upper) {
  const auto n = static_cast<Index>(upper.begin.size()) - 1;
  std::vector<Index> parent(static_cast<std::size_t>(n), kNone), ancestor(parent);
  for (Index k = 0; k < n; ++k) {
    for (std::size_t p = upper.begin[k]; p < upper.begin[k + 1]; ++p) {
      for (Index i = upper.row[p]; i != kNone && i < k;) {
        const Index next = ancestor[i];
        ancestor[i] = k;
        if (next == kNone) parent[i] = k;
        i = next;
      }
    }
  }
  return parent;
}

/// Place of each column in a postorder of the tree: children before parents, contiguous.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> head(parent.size(), kNone), next(parent.size(), kNone), place(parent.size());
  for (Index i = n - 1; i >= 0; --i) {
    if (parent[i] == kNone) continue;
    next[i] = head[parent[i]];
    head[parent[i]] = i;
  }
  Index count = 0;
  std::vector<Index> stack;
  for (Index root = 0; root < n; ++root) {
    if (parent[root] != kNone) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index top = stack.back();
      if (head[top] == kNone) {
        place[top] = count++;
        stack.pop_back();
      } else {
        stack.push_back(head[top]);
        head[top] = next[head[top]];
      }
    }
  }
  return place;
}

/// Entries of each column of L, by walking the row subtrees.
std::vector<Index> column_counts(const UpperPattern& upper, const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> count(parent.size(), 1), seen(parent.size(), kNone);
  for (Index k = 0; k < n; ++k) {
    seen[k] = k;
    for (std::size_t p = upper.begin[k]; p < upper.begin[k + 1]; ++p) {
      for (Index i = upper.row[p]; seen[i] != k; i = parent[i]) {
        ++count[i];
        seen[i] = k;
      }
    }
  }
  return count;
}

/// Whether panels of this width may hold this share of explicit zeros (CHOLMOD's thresholds): wide
/// panels are worth some zeros, for one product then does the work of many.
bool worth_merging(Index width, double zeros, double entries) {
  const double share = entries > 0 ? zeros / entries : 0;
  return width <= 4 || (width <= 16 && share < 0.8) || (width <= 48 && share < 0.1) || share < 0.05;
}

struct Panel {
  Index first, width, below;
  double zeros;
};

/// Fundamental supernodes, then a child merged into its parent when it ends where that begins.
std::vector<Panel> find_panels(const std::vector<Index>& parent, const std::vector<Index>& count) {
  std::vector<Panel> panels;
  const auto n = static_cast<Index>(parent.size());
  for (Index j = 0; j < n; ++j) {
    if (j > 0 && parent[j - 1] == j && count[j - 1] == count[j] + 1) {
      ++panels.back().width;
      --panels.back().below;
      continue;
    }
    panels.push_back({j, 1, count[j] - 1, 0});
  }
  std::vector<Panel> merged;
  for (Panel panel : panels) {
    while (!merged.empty()) {
      const Panel& child = merged.back();
      const Index up = parent[child.first + child.width - 1];
      if (up == kNone || up >= panel.first + panel.width) break;
      const double missing = panel.width + panel.below - child.below;
      const double zeros = child.zeros + panel.zeros + missing * child.width;
      const Index width = child.width + panel.width;
      const double entries = 0.5 * width * (width + 1.0) + static_cast<double>(width) * panel.below;
      if (!worth_merging(width, zeros, entries)) break;
      panel = {child.first, width, panel.below, zeros};
      merged.pop_back();
    }
    merged.push_back(panel);
  }
  return merged;
}

void find_rows(const SparseMatrix& lower, const std::vector<Index>& column_parent, Supernodes& s) {
  std::vector<Index> seen(s.of.size(), kNone);
  std::vector<std::vector<Index>> children(s.parent.size());
  s.row_begin.push_back(0);
  s.value_begin.push_back(0);
  for (Index k = 0; k < s.count(); ++k) {
    const Index end = s.first[k + 1];
    const auto add = [&](Index row) {
      if (row < end || seen[row] == k) return;
      seen[row] = k;
      s.rows.push_back(row);
    };
    for (Index j = s.first[k]; j < end; ++j) {
      for (SparseMatrix::InnerIterator it(lower, j); it; ++it) add(static_cast<Index>(it.row()));
    }
    for (Index child : children[k]) {
      const std::size_t from = s.row_begin[child], to = s.row_begin[child + 1];
      for (std::size_t r = from; r < to; ++r) add(s.rows[r]);
    }
    const auto begin = s.rows.begin() + static_cast<std::ptrdiff_t>(s.row_begin.back());
    std::sort(begin, s.rows.end());
    s.row_begin.push_back(s.rows.size());
    const Index up = column_parent[end - 1];
    s.parent[k] = up == kNone ? kNone : s.of[up];
    if (up != kNone) children[s.parent[k]].push_back(k);
    s.value_begin.push_back(s.value_begin.back() + static_cast<std::size_t>(s.width(k)) *
                                                       static_cast<std::size_t>(s.height(k)));
  }
}

}  // namespace

SparseMatrix permute_lower(const SparseMatrix& lower, const std::vector<Index>& place) {
  Permutation p(static_cast<Index>(place.size()));
  std::copy(place.begin(), place.end(), p.indices().data());
  SparseMatrix result(lower.rows(), lower.cols());
  result.selfadjointView<Eigen::Lower>() = lower.selfadjointView<Eigen::Lower>().twistedBy(p);
  return result;
}

Supernodes find_supernodes(const SparseMatrix& lower, std::vector<Index> place,
                           SparseMatrix& permuted) {
  Supernodes s;
  s.place = place.empty() ? minimum_degree(lower) : std::move(place);
  permuted = permute_lower(lower, s.place);
  const std::vector<Index> post = postorder(elimination_tree(upper_pattern(permuted)));
  for (Index& p : s.place) p = post[p];
  permuted = permute_lower(lower, s.place);
  const UpperPattern upper = upper_pattern(permuted);
  const std::vector<Index> parent = elimination_tree(upper);
  const std::vector<Panel> panels = find_panels(parent, column_counts(upper, parent));
  s.of.resize(s.place.size());
  for (const Panel& panel : panels) {
    const Index end = panel.first + panel.width;
    for (Index first = panel.first; first < end; first += kWidest) {
      const Index width = std::min(kWidest, end - first);
      std::fill_n(s.of.begin() + first, width, static_cast<Index>(s.first.size()));
      s.first.push_back(first);
    }
  }
  s.parent.assign(s.first.size(), kNone);
  s.first.push_back(static_cast<Index>(s.place.size()));
  find_rows(permuted, parent, s);
  return s;
}

}  // namespace sunder::linear_algebra
