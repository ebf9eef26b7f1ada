// SPDX-License-Identifier: Apache-2.0
#include "solver/condensed_update.hpp"

#include <algorithm>

namespace sunder::solver {
namespace {

/// (X B)^T, which is B^T X.
linear_algebra::RowMajor differences_of(const CondensedState& state, std::span<const Index> place) {
  const Eigen::MatrixXd& x = state.x.first();
  linear_algebra::RowMajor result(static_cast<Eigen::Index>(state.vectors.size()), x.rows());
  for (std::size_t i = 0; i < state.vectors.size(); ++i) {
    const auto [dof, other] = state.vectors[i];
    auto row = result.row(static_cast<Eigen::Index>(i));
    row = x.col(place[dof]).transpose();
    if (other != kNone) row -= x.col(place[other]).transpose();
  }
  return result;
}

/// a b by tiles that stay in the cache.
linear_algebra::RowMajor product(const linear_algebra::LeftFactor& a,
                                 const linear_algebra::RowMajor& b) {
  linear_algebra::RowMajor c(a.rows, b.cols());
  std::vector<double> room;
  linear_algebra::packed_product(a, b.data(), b.outerStride(), b.cols(), c.data(), c.outerStride(),
                                 room);
  return c;
}

linear_algebra::RowMajor product(const linear_algebra::RowMajor& symmetric,
                                 const linear_algebra::RowMajor& b) {
  return product(linear_algebra::transposed(symmetric), b);
}

linear_algebra::LeftFactor plain(const linear_algebra::RowMajor& a) {
  return {a.data(), a.rows(), a.cols(), a.outerStride(), 1};
}

/// The forces of the damage under each column's unit load: one step of Deferred::refine().
linear_algebra::RowMajor forces_of(const DamageMatrices& damage,
                                   const linear_algebra::RowMajor& p) {
  linear_algebra::RowMajor x = product(damage.m, p);
  const linear_algebra::RowMajor lack = product(damage.d, product(damage.compliance, x) + p) - x;
  x += lack + product(damage.m, product(damage.compliance, lack));
  return x;
}

/// Some rows of a symmetric X.
linear_algebra::RowMajor rows_of(const Eigen::MatrixXd& x, std::span<const Index> places) {
  linear_algebra::RowMajor rows(static_cast<Eigen::Index>(places.size()), x.cols());
  for (std::size_t i = 0; i < places.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = x.col(places[i]).transpose();
  }
  return rows;
}

/// Adds D u to forces, row by row; f has a column for each unknown of D, which are `columns`.
void add_lost(const LostStiffness& lost, const linear_algebra::RowMajor& u,
              std::span<const Index> places, std::span<const Index> columns,
              linear_algebra::RowMajor& f) {
  std::vector<double> moved(places.size()), forces(places.size());
  for (Eigen::Index j = 0; j < u.rows(); ++j) {
    for (std::size_t i = 0; i < places.size(); ++i) moved[i] = u(j, places[i]);
    lost.multiply(moved, forces);
    for (std::size_t i = 0; i < places.size(); ++i) f(j, columns[i]) += forces[i];
  }
}

/// Responses u (a row each) to unit forces, made exact: with D what was lost since the factor and
/// X0 its inverse, g = X0 (f + D u) - u is lacking there, and g + X D g in the body as it is.
void make_exact(const CondensedState& state, std::span<const Index> place,
                std::span<const Difference> forces, linear_algebra::RowMajor& u) {
  std::vector<Index> lost, acted, column(place.size(), kNone), columns;
  for (Index d : state.lost->dofs()) lost.push_back(place[d]);
  const auto act = [&](Index d) {
    if (d == kNone || column[d] != kNone) return;
    column[d] = static_cast<Index>(acted.size());
    acted.push_back(place[d]);
  };
  for (Index d : state.lost->dofs()) {
    act(d);
    columns.push_back(column[d]);
  }
  for (const Difference& v : forces) {
    act(v.dof);
    act(v.other);
  }
  linear_algebra::RowMajor f =
      linear_algebra::RowMajor::Zero(u.rows(), static_cast<Eigen::Index>(acted.size()));
  for (std::size_t j = 0; j < forces.size(); ++j) {
    f(static_cast<Eigen::Index>(j), column[forces[j].dof]) = 1;
    if (forces[j].other != kNone) f(static_cast<Eigen::Index>(j), column[forces[j].other]) = -1;
  }
  add_lost(*state.lost, u, lost, columns, f);
  const linear_algebra::RowMajor g =
      product(plain(f), rows_of(state.x_of_factor.first(), acted)) - u;
  f.setZero(u.rows(), static_cast<Eigen::Index>(lost.size()));
  add_lost(*state.lost, g, lost, columns, f);
  u += g + product(plain(f), rows_of(state.x.first(), lost));
}

/// B^T u for each row u over S, as a row.
linear_algebra::RowMajor projected(const CondensedState& state, std::span<const Index> place,
                                   const linear_algebra::RowMajor& rows) {
  linear_algebra::RowMajor result(rows.rows(), static_cast<Eigen::Index>(state.vectors.size()));
  if (rows.rows() == 0) return result;  // no load: there is no memory to point into
  for (std::size_t i = 0; i < state.vectors.size(); ++i) {
    const auto [dof, other] = state.vectors[i];
    auto column = result.col(static_cast<Eigen::Index>(i));
    column = rows.col(place[dof]);
    if (other != kNone) column -= rows.col(place[other]);
  }
  return result;
}

/// What an update works with.
struct Parts {
  linear_algebra::RowMajor columns, at_loads;  // (X B)^T, and X under the loads row by row
  linear_algebra::RowMajor p;                  // B^T X
  std::vector<Index> loaded, of_load;  // places of the loads; per place: which load, or kNone
  DamageMatrices damage;
};

/// All that the damage and the loads act through.
void make_exact(const CondensedState& state, std::span<const Index> place,
                std::span<const Index> loaded, Parts& parts) {
  const auto r = static_cast<Eigen::Index>(state.vectors.size());
  std::vector<Difference> forces = state.vectors;
  for (Index d : loaded) {
    if (place[d] == kNone || parts.of_load[place[d]] != kNone) continue;
    parts.of_load[place[d]] = static_cast<Index>(parts.loaded.size());
    parts.loaded.push_back(place[d]);
    forces.push_back({d, kNone});
  }
  linear_algebra::RowMajor u(static_cast<Eigen::Index>(forces.size()), state.x.first().rows());
  u.topRows(r) = parts.columns;
  u.bottomRows(u.rows() - r) = rows_of(state.x.first(), parts.loaded);
  make_exact(state, place, forces, u);
  parts.columns = u.topRows(r);
  parts.at_loads = u.bottomRows(u.rows() - r);
  parts.damage.compliance = projected(state, place, parts.columns);
  parts.p = parts.columns;
  const linear_algebra::RowMajor under_loads = projected(state, place, parts.at_loads);
  for (std::size_t l = 0; l < parts.loaded.size(); ++l) {
    parts.p.col(parts.loaded[l]) = under_loads.row(static_cast<Eigen::Index>(l)).transpose();
  }
}

/// X + X B x, its lower triangle: some columns at a time, which stay in the cache.
void add_lower(const CondensedState& state, const Parts& parts, const linear_algebra::RowMajor& x,
               Eigen::MatrixXd& result) {
  constexpr Eigen::Index kColumns = 64;
  const Eigen::Index n = state.x.first().rows();
  linear_algebra::RowMajor share(kColumns, n);
  std::vector<double> room;
  for (Eigen::Index first = 0; first < n; first += kColumns) {
    const Eigen::Index count = std::min(kColumns, n - first), below = n - first;
    // Column by column, which packed_product() takes for rows.
    linear_algebra::packed_product({x.data() + first, count, x.rows(), 1, x.outerStride()},
                                   parts.columns.data() + first, parts.columns.outerStride(), below,
                                   share.data(), share.outerStride(), room);
    for (Eigen::Index j = 0; j < count; ++j) {
      auto column = result.col(first + j).tail(below);
      column = share.row(j).head(below).transpose();
      const Index load = parts.of_load[static_cast<std::size_t>(first + j)];
      if (load != kNone) {
        column += parts.at_loads.row(load).tail(below).transpose();
        continue;
      }
      column += state.x.first().col(first + j).tail(below);
      for (std::size_t l = 0; l < parts.loaded.size(); ++l) {
        const Index at = parts.loaded[l];
        if (at < first) continue;
        result(at, first + j) += parts.at_loads(static_cast<Eigen::Index>(l), first + j) -
                                 state.x.first()(at, first + j);
      }
    }
  }
}

void mirror_lower(Eigen::MatrixXd& x) {
  constexpr Eigen::Index kSquare = 64;
  const Eigen::Index n = x.rows();
  for (Eigen::Index j = 0; j < n; j += kSquare) {
    const Eigen::Index width = std::min(kSquare, n - j);
    for (Eigen::Index i = j; i < n; i += kSquare) {
      const Eigen::Index height = std::min(kSquare, n - i);
      if (i > j) {
        x.block(j, i, width, height) = x.block(i, j, height, width).transpose();
        continue;
      }
      for (Eigen::Index c = j; c < j + width; ++c) {
        for (Eigen::Index r = c + 1; r < i + height; ++r) x(c, r) = x(r, c);
      }
    }
  }
}

}  // namespace

Eigen::MatrixXd updated_inverse(const CondensedState& state, const DamageMatrices& damage,
                                std::span<const Index> loaded) {
  std::vector<Index> place(static_cast<std::size_t>(state.factor->cholesky().size()), kNone);
  for (std::size_t i = 0; i < state.dofs.size(); ++i) place[state.dofs[i]] = static_cast<Index>(i);
  Parts parts;
  parts.columns = differences_of(state, place);
  parts.of_load.assign(state.dofs.size(), kNone);
  const auto r = static_cast<Eigen::Index>(state.vectors.size());
  parts.damage = {damage.compliance.topLeftCorner(r, r), damage.m.topLeftCorner(r, r),
                  damage.d.topLeftCorner(r, r)};
  if (state.lost) {
    make_exact(state, place, loaded, parts);
  } else {
    parts.p = parts.columns;
  }
  const linear_algebra::RowMajor x = forces_of(parts.damage, parts.p);
  Eigen::MatrixXd result(state.x.first().rows(), state.x.first().rows());
  add_lower(state, parts, x, result);
  mirror_lower(result);
  return result;
}

}  // namespace sunder::solver
