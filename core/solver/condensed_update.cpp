// SPDX-License-Identifier: Apache-2.0
#include "solver/condensed_update.hpp"

#include <algorithm>

#include "linear_algebra/shared_loop.hpp"

namespace sunder::solver {
namespace {

using linear_algebra::RowMajor;

// Columns of a pass: what it works on stays in the cache, and factors are packed once for it.
constexpr Eigen::Index kColumns = 256;

/// A loop's threads, and room for each one's products.
class Threads {
 public:
  explicit Threads(const linear_algebra::FactorWork& work)
      : loop_(work.threads, work.stop), rooms_(static_cast<std::size_t>(loop_.count())) {}

  /// body(i, room) for each i below `count`.
  template <class Body>
  void each(Eigen::Index count, Body&& body) {
    const bool done = loop_.run(static_cast<Index>(count), [&](Index i, int worker) {
      body(Eigen::Index{i}, rooms_[static_cast<std::size_t>(worker)]);
    });
    if (!done) throw linear_algebra::Stopped();
  }
  /// body(first, width, room) for so many columns, some at a time.
  template <class Body>
  void each_columns(Eigen::Index columns, Eigen::Index at_once, Body&& body) {
    each((columns + at_once - 1) / at_once, [&](Eigen::Index i, std::vector<double>& room) {
      const Eigen::Index first = i * at_once;
      body(first, std::min(at_once, columns - first), room);
    });
  }

 private:
  linear_algebra::SharedLoop loop_;
  std::vector<std::vector<double>> rooms_;
};

/// (X B)^T, which is B^T X.
RowMajor differences_of(const CondensedState& state, std::span<const Index> place,
                        Threads& threads) {
  const Eigen::MatrixXd& x = state.x.first();
  RowMajor result(static_cast<Eigen::Index>(state.vectors.size()), x.rows());
  threads.each(result.rows(), [&](Eigen::Index i, std::vector<double>&) {
    const auto [dof, other] = state.vectors[static_cast<std::size_t>(i)];
    auto row = result.row(i);
    row = x.col(place[dof]).transpose();
    if (other != kNone) row -= x.col(place[other]).transpose();
  });
  return result;
}

linear_algebra::LeftFactor plain(const RowMajor& a) {
  return {a.data(), a.rows(), a.cols(), a.outerStride(), 1};
}

/// c = a b of some columns of b, by tiles that stay in the cache.
void product(const linear_algebra::LeftFactor& a, const double* b, Eigen::Index b_stride,
             Eigen::Index width, RowMajor& c, std::vector<double>& room) {
  c.resize(a.rows, width);
  linear_algebra::packed_product(a, b, b_stride, width, c.data(), c.outerStride(), room);
}

/// The forces of the damage under each column's unit load: one step of Deferred::refine().
RowMajor forces_of(const DamageMatrices& damage, const RowMajor& p, Threads& threads) {
  const Eigen::Index k = p.rows(), n = p.cols();
  RowMajor result(k, n), m_compliance(k, k);
  threads.each_columns(k, kColumns, [&](Eigen::Index first, Eigen::Index width, auto& room) {
    linear_algebra::packed_product(plain(damage.m), damage.compliance.data() + first,
                                   damage.compliance.outerStride(), width,
                                   m_compliance.data() + first, k, room);
  });
  threads.each_columns(n, kColumns, [&](Eigen::Index first, Eigen::Index width, auto& room) {
    RowMajor x, moved, lack, mended;
    const auto columns = p.middleCols(first, width);
    product(plain(damage.m), p.data() + first, n, width, x, room);
    product(plain(damage.compliance), x.data(), width, width, moved, room);
    moved += columns;
    product(plain(damage.d), moved.data(), width, width, lack, room);
    lack -= x;
    product(plain(m_compliance), lack.data(), width, width, mended, room);
    result.middleCols(first, width) = x + (lack + mended);
  });
  return result;
}

/// f times the rows of a symmetric X at some places, added to each column of `to`.
void add_product(const RowMajor& f, const Eigen::MatrixXd& x, std::span<const Index> places,
                 RowMajor& to, Threads& threads) {
  threads.each_columns(x.cols(), kColumns, [&](Eigen::Index first, Eigen::Index width, auto& room) {
    RowMajor rows(static_cast<Eigen::Index>(places.size()), width), share;
    for (std::size_t i = 0; i < places.size(); ++i) {
      rows.row(static_cast<Eigen::Index>(i)) = x.col(places[i]).segment(first, width).transpose();
    }
    product(plain(f), rows.data(), width, width, share, room);
    to.middleCols(first, width) += share;
  });
}

/// Some rows of a symmetric X.
RowMajor rows_of(const Eigen::MatrixXd& x, std::span<const Index> places) {
  RowMajor rows(static_cast<Eigen::Index>(places.size()), x.cols());
  for (std::size_t i = 0; i < places.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = x.col(places[i]).transpose();
  }
  return rows;
}

/// Adds D u to forces, row by row; f has a column for each unknown of D, which are `columns`.
void add_lost(const LostStiffness& lost, const RowMajor& u, std::span<const Index> places,
              std::span<const Index> columns, RowMajor& f, Threads& threads) {
  threads.each(u.rows(), [&](Eigen::Index j, std::vector<double>& room) {
    room.resize(std::max(room.size(), 2 * places.size()));
    const std::span<double> moved(room.data(), places.size()),
        forces(room.data() + places.size(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i) moved[i] = u(j, places[i]);
    lost.multiply(moved, forces);
    for (std::size_t i = 0; i < places.size(); ++i) f(j, columns[i]) += forces[i];
  });
}

/// Responses u (a row each) to unit forces, made exact: with D what was lost since the factor and
/// X0 its inverse, g = X0 (f + D u) - u is lacking there, and g + X D g in the body as it is.
void make_exact(const CondensedState& state, std::span<const Index> place,
                std::span<const Difference> forces, RowMajor& u, Threads& threads) {
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
  RowMajor f = RowMajor::Zero(u.rows(), static_cast<Eigen::Index>(acted.size()));
  for (std::size_t j = 0; j < forces.size(); ++j) {
    f(static_cast<Eigen::Index>(j), column[forces[j].dof]) = 1;
    if (forces[j].other != kNone) f(static_cast<Eigen::Index>(j), column[forces[j].other]) = -1;
  }
  add_lost(*state.lost, u, lost, columns, f, threads);
  RowMajor g = -u;
  add_product(f, state.x_of_factor.first(), acted, g, threads);
  f.setZero(u.rows(), static_cast<Eigen::Index>(lost.size()));
  add_lost(*state.lost, g, lost, columns, f, threads);
  u += g;
  add_product(f, state.x.first(), lost, u, threads);
}

/// B^T u for each row u over S, as a row.
RowMajor projected(const CondensedState& state, std::span<const Index> place,
                   const RowMajor& rows) {
  RowMajor result(rows.rows(), static_cast<Eigen::Index>(state.vectors.size()));
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
  RowMajor columns, at_loads;          // (X B)^T, and X under the loads row by row
  RowMajor p;                          // B^T X
  std::vector<Index> loaded, of_load;  // places of the loads; per place: which load, or kNone
  DamageMatrices damage;
};

/// All that the damage and the loads act through.
void make_exact(const CondensedState& state, std::span<const Index> place,
                std::span<const Index> loaded, Parts& parts, Threads& threads) {
  const auto r = static_cast<Eigen::Index>(state.vectors.size());
  std::vector<Difference> forces = state.vectors;
  for (Index d : loaded) {
    if (place[d] == kNone || parts.of_load[place[d]] != kNone) continue;
    parts.of_load[place[d]] = static_cast<Index>(parts.loaded.size());
    parts.loaded.push_back(place[d]);
    forces.push_back({d, kNone});
  }
  RowMajor u(static_cast<Eigen::Index>(forces.size()), state.x.first().rows());
  u.topRows(r) = parts.columns;
  u.bottomRows(u.rows() - r) = rows_of(state.x.first(), parts.loaded);
  make_exact(state, place, forces, u, threads);
  parts.columns = u.topRows(r);
  parts.at_loads = u.bottomRows(u.rows() - r);
  parts.damage.compliance = projected(state, place, parts.columns);
  parts.p = parts.columns;
  const RowMajor under_loads = projected(state, place, parts.at_loads);
  for (std::size_t l = 0; l < parts.loaded.size(); ++l) {
    parts.p.col(parts.loaded[l]) = under_loads.row(static_cast<Eigen::Index>(l)).transpose();
  }
}

/// X + X B x, its lower triangle: some columns at a time, which stay in the cache.
void add_lower(const CondensedState& state, const Parts& parts, const RowMajor& x,
               Eigen::MatrixXd& result, Threads& threads) {
  constexpr Eigen::Index kAtOnce = 64;
  const Eigen::Index n = state.x.first().rows();
  threads.each_columns(n, kAtOnce, [&](Eigen::Index first, Eigen::Index count, auto& room) {
    const Eigen::Index below = n - first;
    RowMajor share(count, below);
    // Column by column, which packed_product() takes for rows.
    linear_algebra::packed_product({x.data() + first, count, x.rows(), 1, x.outerStride()},
                                   parts.columns.data() + first, parts.columns.outerStride(), below,
                                   share.data(), share.outerStride(), room);
    for (Eigen::Index j = 0; j < count; ++j) {
      auto column = result.col(first + j).tail(below);
      column = share.row(j).transpose();
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
  });
}

void mirror_lower(Eigen::MatrixXd& x, Threads& threads) {
  constexpr Eigen::Index kSquare = 64;
  const Eigen::Index n = x.rows();
  threads.each_columns(n, kSquare, [&](Eigen::Index j, Eigen::Index width, auto&) {
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
  });
}

}  // namespace

Eigen::MatrixXd updated_inverse(const CondensedState& state, const DamageMatrices& damage,
                                std::span<const Index> loaded,
                                const linear_algebra::FactorWork& work) {
  Threads threads(work);
  std::vector<Index> place(static_cast<std::size_t>(state.factor->cholesky().size()), kNone);
  for (std::size_t i = 0; i < state.dofs.size(); ++i) place[state.dofs[i]] = static_cast<Index>(i);
  Parts parts;
  parts.columns = differences_of(state, place, threads);
  parts.of_load.assign(state.dofs.size(), kNone);
  const auto r = static_cast<Eigen::Index>(state.vectors.size());
  parts.damage = {damage.compliance.topLeftCorner(r, r), damage.m.topLeftCorner(r, r),
                  damage.d.topLeftCorner(r, r)};
  if (state.lost) {
    make_exact(state, place, loaded, parts, threads);
  } else {
    parts.p = parts.columns;
  }
  const RowMajor x = forces_of(parts.damage, parts.p, threads);
  Eigen::MatrixXd result(state.x.first().rows(), state.x.first().rows());
  add_lower(state, parts, x, result, threads);
  mirror_lower(result, threads);
  return result;
}

}  // namespace sunder::solver
