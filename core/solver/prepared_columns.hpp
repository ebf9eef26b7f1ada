// SPDX-License-Identifier: Apache-2.0
// Columns of L^-1 P B computed ahead of the fracture that may need them. A column depends on the
// factor and its vector alone, so that taking it from here changes no bit.
#pragma once

#include <span>
#include <vector>

#include "linear_algebra/row_product.hpp"
#include "linear_algebra/supernodes.hpp"
#include "solver/difference_basis.hpp"

namespace sunder::solver {

class PreparedColumns {
 public:
  explicit PreparedColumns(const linear_algebra::Supernodes& nodes) : nodes_(nodes) {}

  /// Drops all columns but these; the first time it makes room for those to come.
  void retain(std::span<const Difference> vectors);
  [[nodiscard]] bool holds(const Difference& vector) const { return find(vector) != nullptr; }
  /// Keeps one column of `rows` on the supernodes of `path`, which took so long to compute.
  void keep(const Difference& vector, std::span<const Index> path,
            const linear_algebra::RowMajor& rows, Index column, double milliseconds);
  /// Copies a column that it holds to one of `rows`.
  void restore(const Difference& vector, linear_algebra::RowMajor& rows, Index column);

  /// What the restored columns had taken to compute.
  [[nodiscard]] double saved_ms() const { return saved_ms_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Column {
    Difference vector;
    std::size_t path, values;  // where they begin in the lists; they end where the next begin
    double milliseconds = 0;
  };
  [[nodiscard]] const Column* find(const Difference& vector) const;

  const linear_algebra::Supernodes& nodes_;
  std::vector<Column> columns_;
  std::vector<Index> paths_;  // of all columns, one after the other
  std::vector<double> values_;
  double saved_ms_ = 0;
};

}  // namespace sunder::solver
