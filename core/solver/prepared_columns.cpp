// SPDX-License-Identifier: Apache-2.0
#include "solver/prepared_columns.hpp"

#include <algorithm>

namespace sunder::solver {

const PreparedColumns::Column* PreparedColumns::find(const Difference& vector) const {
  for (const Column& c : columns_) {
    if (c.vector.dof == vector.dof && c.vector.other == vector.other) return &c;
  }
  return nullptr;
}

/// Closes the gaps that the dropped columns leave.
void PreparedColumns::retain(std::span<const Difference> vectors) {
  constexpr std::size_t kColumns = 4096, kPaths = std::size_t{1} << 20,
                        kValues = std::size_t{1} << 22;
  columns_.reserve(kColumns);  // all three do nothing from the second time on
  paths_.reserve(kPaths);
  values_.reserve(kValues);
  const auto wanted = [&](const Column& c) {
    return std::ranges::any_of(vectors, [&](const Difference& v) {
      return v.dof == c.vector.dof && v.other == c.vector.other;
    });
  };
  std::size_t kept = 0;
  auto path = paths_.begin();
  auto value = values_.begin();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column c = columns_[i];
    const bool last = i + 1 == columns_.size();
    const std::size_t path_end = last ? paths_.size() : columns_[i + 1].path;
    const std::size_t values_end = last ? values_.size() : columns_[i + 1].values;
    if (!wanted(c)) continue;
    columns_[kept++] = {c.vector, static_cast<std::size_t>(path - paths_.begin()),
                        static_cast<std::size_t>(value - values_.begin()), c.milliseconds};
    if (kept == i + 1) {  // nothing was dropped before it
      path = paths_.begin() + static_cast<std::ptrdiff_t>(path_end);
      value = values_.begin() + static_cast<std::ptrdiff_t>(values_end);
      continue;
    }
    path = std::copy(paths_.begin() + static_cast<std::ptrdiff_t>(c.path),
                     paths_.begin() + static_cast<std::ptrdiff_t>(path_end), path);
    value = std::copy(values_.begin() + static_cast<std::ptrdiff_t>(c.values),
                      values_.begin() + static_cast<std::ptrdiff_t>(values_end), value);
  }
  columns_.resize(kept);
  paths_.erase(path, paths_.end());
  values_.erase(value, values_.end());
}

void PreparedColumns::keep(const Difference& vector, std::span<const Index> path,
                           const linear_algebra::RowMajor& rows, Index column,
                           double milliseconds) {
  columns_.push_back({vector, paths_.size(), values_.size(), milliseconds});
  paths_.insert(paths_.end(), path.begin(), path.end());
  for (Index s : path) {
    for (Index r = nodes_.first[s]; r < nodes_.first[s + 1]; ++r) {
      values_.push_back(rows(r, column));
    }
  }
}

void PreparedColumns::restore(const Difference& vector, linear_algebra::RowMajor& rows,
                              Index column) {
  const Column& c = *find(vector);
  const bool last = &c == &columns_.back();
  const std::size_t path_end = last ? paths_.size() : (&c)[1].path;
  const double* value = values_.data() + c.values;
  for (std::size_t p = c.path; p < path_end; ++p) {
    const Index s = paths_[p];
    for (Index r = nodes_.first[s]; r < nodes_.first[s + 1]; ++r) rows(r, column) = *value++;
  }
  saved_ms_ += c.milliseconds;
}

std::size_t PreparedColumns::bytes() const {
  return values_.size() * sizeof(double) + paths_.size() * sizeof(Index);
}

}  // namespace sunder::solver
