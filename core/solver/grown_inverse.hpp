// SPDX-License-Identifier: Apache-2.0
// A symmetric inverse that takes further unknowns without a copy of what is there.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>

#include "sunder/types.hpp"

namespace sunder::solver {

/// What there was at first is shared and nobody writes it. What has come since stands beside it,
/// each column in two pieces: the rows of the first unknowns and those of the further ones. A copy
/// shares all of that and knows how much there was when it was made: it may be read while another
/// thread adds to the original.
class GrownInverse {
 public:
  GrownInverse() = default;
  /// Square and symmetric.
  explicit GrownInverse(std::shared_ptr<const Eigen::MatrixXd> first) : first_(std::move(first)) {}

  [[nodiscard]] Eigen::Index size() const { return first_rows() + added_; }
  [[nodiscard]] Eigen::Index first_rows() const { return first_ ? first_->rows() : 0; }
  /// Unknowns that have come.
  [[nodiscard]] Eigen::Index added() const { return added_; }

  struct Column {
    const double *first, *added;
    Eigen::Index first_rows;
    double operator[](Eigen::Index i) const {
      return i < first_rows ? first[i] : added[i - first_rows];
    }
  };
  [[nodiscard]] Column column(Eigen::Index j) const;

  /// Columns of further unknowns, which are the last ones: shape (size() + k) x k. Of several
  /// copies one alone may add.
  void add(const Eigen::MatrixXd& columns);
  /// Takes the last ones away, down to so many unknowns that have come. Copies that know of them
  /// must not be read any more.
  void keep_added(Eigen::Index added) { added_ = std::min(added_, added); }
  /// As one matrix: that of the beginning where nothing has come, else a new one.
  [[nodiscard]] std::shared_ptr<const Eigen::MatrixXd> whole() const;
  /// That of the beginning: all of it where nothing has come.
  [[nodiscard]] const Eigen::MatrixXd& first() const { return *first_; }
  [[nodiscard]] bool same_as(const GrownInverse& other) const {
    return first_ == other.first_ && right_ == other.right_ && added_ == other.added_;
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  void make_room(Eigen::Index added);

  std::shared_ptr<const Eigen::MatrixXd> first_;
  // Columns of further unknowns, rows of the first ones; rows of further unknowns, every column.
  std::shared_ptr<Eigen::MatrixXd> right_, below_;
  Eigen::Index added_ = 0;
};

}  // namespace sunder::solver
