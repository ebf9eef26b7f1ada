// SPDX-License-Identifier: Apache-2.0
#include "solver/region_growth.hpp"

#include <algorithm>
#include <exception>

namespace sunder::solver {
namespace {

// New columns are computed once something so near an event is neither in S nor there.
constexpr int kNearRings = 2, kAllRings = 64;
constexpr std::size_t kNear = RegionGrowth::kUnknowns / 2;
// Columns that become ready together: the factor is read once for them, and they take as many
// vectors of the whole body meanwhile.
constexpr std::size_t kTogether = 16;

bool has_all(std::span<const Index> at, std::span<const Index> of, std::size_t end) {
  return std::ranges::all_of(of, [&](Index d) {
    return at[static_cast<std::size_t>(d)] != kNone &&
           static_cast<std::size_t>(at[static_cast<std::size_t>(d)]) < end;
  });
}

}  // namespace

RegionGrowth::~RegionGrowth() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  asked_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void RegionGrowth::follow(const std::shared_ptr<const linear_algebra::Factor>& factor,
                          std::span<const Index> inside, std::span<const Index> touched) noexcept {
  try {
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    const std::lock_guard lock(mutex_);
    if (waiting_ == kHands) {
      std::rotate(requests_.begin(), requests_.begin() + 1, requests_.end());
      --waiting_;
    }
    Request& request = requests_[waiting_];
    request.factor = factor;
    request.inside.assign(inside.begin(), inside.end());
    request.touched.assign(touched.begin(), touched.end());
    ++waiting_;
  } catch (const std::exception&) {
    return;  // frames solve for what they need
  }
  asked_.notify_one();
}

bool RegionGrowth::take(const linear_algebra::Factor& factor, std::span<const Index> rows,
                        std::span<const Index> unknowns, Eigen::MatrixXd& columns) {
  const std::lock_guard lock(mutex_);
  for (const auto& store : stores_) {
    if (store->factor.get() != &factor || !has_all(store->place, unknowns, store->done) ||
        !has_all(store->row, rows, store->rows.size())) {
      continue;
    }
    columns.resize(static_cast<Eigen::Index>(rows.size()),
                   static_cast<Eigen::Index>(unknowns.size()));
    for (std::size_t j = 0; j < unknowns.size(); ++j) {
      const auto from = store->columns.col(store->place[unknowns[j]]);
      auto to = columns.col(static_cast<Eigen::Index>(j));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        to[static_cast<Eigen::Index>(i)] = from[store->row[rows[i]]];
      }
    }
    taken_ += unknowns.size();
    return true;
  }
  return false;
}

void RegionGrowth::forget() {
  {
    const std::lock_guard lock(mutex_);
    ++age_;
    waiting_ = 0;
    for (Request& request : requests_) request.factor.reset();
    dropped_.insert(dropped_.end(), stores_.begin(), stores_.end());
    stores_.clear();
  }
  asked_.notify_one();
}

void RegionGrowth::wait() {
  Lock lock(mutex_);
  done_.wait(lock, [this] { return waiting_ == 0 && !busy_; });
}

std::size_t RegionGrowth::taken() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

std::size_t RegionGrowth::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = 0;
  for (const auto& store : stores_) {
    bytes +=
        static_cast<std::size_t>(store->columns.size()) * sizeof(double) +
        (store->unknowns.size() + store->rows.size() + store->place.size() + store->row.size()) *
            sizeof(Index);
  }
  if (!stores_.empty()) bytes += kTogether * node_.size() * sizeof(double);
  return bytes;
}

void RegionGrowth::run() {
  Lock lock(mutex_);
  for (;;) {
    asked_.wait(lock, [this] { return quit_ || waiting_ > 0 || !dropped_.empty(); });
    if (quit_) return;
    busy_ = true;
    Stores dropped;
    dropped.swap(dropped_);
    Request request;
    if (waiting_ > 0) {
      std::swap(request, requests_[0]);
      std::rotate(requests_.begin(), requests_.begin() + 1, requests_.end());
      --waiting_;
    }
    try {
      if (request.factor) make(lock, request);
    } catch (const std::exception&) {  // out of memory: frames solve for what they need
      if (!lock.owns_lock()) lock.lock();
    }
    lock.unlock();
    dropped.clear();  // it takes a while to free, as does a factor that nobody else holds
    request = {};
    lock.lock();
    busy_ = false;
    done_.notify_all();
  }
}

/// Elements of every node, and the node of every unknown.
void RegionGrowth::number_nodes() {
  if (!node_.empty()) return;
  const auto& tets = problem_.mesh().tets;
  first_.assign(static_cast<std::size_t>(problem_.node_count()) + 1, 0);
  for (const auto& tet : tets) {
    for (Index n : tet) ++first_[static_cast<std::size_t>(n) + 1];
  }
  for (std::size_t n = 1; n < first_.size(); ++n) first_[n] += first_[n - 1];
  elements_.resize(4 * tets.size());
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (std::size_t e = 0; e < tets.size(); ++e) {
    for (Index n : tets[e]) elements_[static_cast<std::size_t>(next[n]++)] = static_cast<Index>(e);
  }
  std::vector<Index> node(static_cast<std::size_t>(problem_.dof_count()));
  for (Index n = 0; n < problem_.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (const Index d = problem_.dof(n, axis); d != kNone) node[d] = n;
    }
  }
  node_ = std::move(node);
}

/// Unknowns outside S within some rings of elements, the nearest first, `most` at most.
std::vector<Index> RegionGrowth::around(const Request& request, int rings, std::size_t most) const {
  std::vector<std::uint8_t> inside(node_.size(), 0),
      seen(static_cast<std::size_t>(problem_.node_count()), 0);
  for (Index d : request.inside) inside[d] = 1;
  std::vector<Index> ring, next, found;
  const auto see = [&](Index n, std::vector<Index>& to) {
    if (seen[n]) return;
    seen[n] = 1;
    to.push_back(n);
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      if (d != kNone && !inside[d]) found.push_back(d);
    }
  };
  for (Index d : request.touched) see(node_[d], ring);
  for (int r = 0; r < rings && found.size() < most && !ring.empty(); ++r) {
    next.clear();
    for (Index n : ring) {
      for (Index i = first_[n]; i < first_[n + 1]; ++i) {
        for (Index other : problem_.mesh().tets[elements_[i]]) see(other, next);
      }
    }
    std::swap(ring, next);
  }
  if (found.size() > most) found.resize(most);
  return found;
}

bool RegionGrowth::serves(const Store& store, const Request& request,
                          std::span<const Index> near) const {
  return store.factor == request.factor && has_all(store.place, near, store.done) &&
         has_all(store.row, request.inside, store.rows.size());
}

/// Whether something near one of the events is among its columns.
bool RegionGrowth::wanted(const Store& store, std::span<const Request> requests) const {
  return std::ranges::any_of(requests, [&](const Request& request) {
    return std::ranges::any_of(around(request, kNearRings, kNear),
                               [&](Index d) { return store.place[d] != kNone; });
  });
}

std::shared_ptr<RegionGrowth::Store> RegionGrowth::store_for(const Request& request,
                                                             const Stores& others) const {
  auto store = std::make_shared<Store>();
  store->factor = request.factor;
  store->unknowns = around(request, kAllRings, kUnknowns);
  store->place.assign(node_.size(), kNone);
  store->row.assign(node_.size(), kNone);
  const auto add_rows = [&](std::span<const Index> of) {
    for (Index d : of) {
      if (store->row[d] != kNone) continue;
      store->row[d] = static_cast<Index>(store->rows.size());
      store->rows.push_back(d);
    }
  };
  add_rows(request.inside);
  add_rows(store->unknowns);
  // S may grow by what another hand touches before these are taken.
  for (const auto& other : others) {
    if (other->factor == request.factor) add_rows(other->unknowns);
  }
  for (std::size_t i = 0; i < store->unknowns.size(); ++i) {
    store->place[store->unknowns[i]] = static_cast<Index>(i);
  }
  store->columns.resize(static_cast<Eigen::Index>(store->rows.size()),
                        static_cast<Eigen::Index>(store->unknowns.size()));
  return store;
}

void RegionGrowth::make(Lock& lock, const Request& request) {
  const std::uint64_t age = age_;
  const Stores stores = stores_;
  lock.unlock();
  number_nodes();
  const std::vector<Index> near = around(request, kNearRings, kNear);
  const bool served = near.empty() || std::ranges::any_of(stores, [&](const auto& store) {
                        return serves(*store, request, near);
                      });
  const std::shared_ptr<Store> store = served ? nullptr : store_for(request, stores);
  lock.lock();
  if (served || age != age_) return;
  if (stores_.size() == kPlaces) {
    dropped_.push_back(stores_.back());
    stores_.pop_back();
  }
  stores_.insert(stores_.begin(), store);
  fill(lock, *store, age);
}

/// Until all is there, another factor comes, or both hands are elsewhere.
void RegionGrowth::fill(Lock& lock, Store& store, std::uint64_t age) {
  const std::span<const Index> all = store.unknowns;
  for (std::size_t first = 0; first < all.size(); first += kTogether) {
    if (quit_ || age != age_) return;
    if (waiting_ == kHands) {
      const std::vector<Request> later(requests_.begin(), requests_.end());
      lock.unlock();
      const bool goes_on = wanted(store, later);
      lock.lock();
      if (!goes_on) return;
    }
    lock.unlock();
    const auto some = all.subspan(first, std::min(kTogether, all.size() - first));
    store.columns.middleCols(static_cast<Eigen::Index>(first),
                             static_cast<Eigen::Index>(some.size())) =
        store.factor->inverse_block(store.rows, some);
    lock.lock();
    store.done = first + some.size();
  }
}

}  // namespace sunder::solver
