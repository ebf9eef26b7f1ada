// SPDX-License-Identifier: Apache-2.0
#include "engine/prepared_columns.hpp"

#include <algorithm>

namespace sunder::engine {

const PreparedColumns::Column* PreparedColumns::find(const Difference& vector) const {
  for (std::size_t i = 0; i < used_; ++i) {
    const Difference& v = columns_[i].vector;
    if (v.dof == vector.dof && v.other == vector.other) return &columns_[i];
  }
  return nullptr;
}

void PreparedColumns::retain(std::span<const Difference> vectors) {
  const auto wanted = [&](const Column& c) {
    return std::ranges::any_of(vectors, [&](const Difference& v) {
      return v.dof == c.vector.dof && v.other == c.vector.other;
    });
  };
  for (std::size_t i = 0; i < used_;) {
    if (wanted(columns_[i])) {
      ++i;
    } else {
      std::swap(columns_[i], columns_[--used_]);
    }
  }
}

void PreparedColumns::keep(const Difference& vector, std::span<const Index> path,
                           const fem::RowMajor& rows, Index column, double milliseconds) {
  if (used_ == columns_.size()) columns_.emplace_back();
  Column& c = columns_[used_++];
  c.vector = vector;
  c.path.assign(path.begin(), path.end());
  c.values.clear();
  for (Index s : path) {
    for (Index r = nodes_.first[s]; r < nodes_.first[s + 1]; ++r) {
      c.values.push_back(rows(r, column));
    }
  }
  c.milliseconds = milliseconds;
}

void PreparedColumns::restore(const Difference& vector, fem::RowMajor& rows, Index column) {
  const Column& c = *find(vector);
  const double* value = c.values.data();
  for (Index s : c.path) {
    for (Index r = nodes_.first[s]; r < nodes_.first[s + 1]; ++r) rows(r, column) = *value++;
  }
  saved_ms_ += c.milliseconds;
}

std::size_t PreparedColumns::bytes() const {
  std::size_t sum = 0;
  for (const Column& c : columns_) {
    sum += c.values.capacity() * sizeof(double) + c.path.capacity() * sizeof(Index);
  }
  return sum;
}

}  // namespace sunder::engine
