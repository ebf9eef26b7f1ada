// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/patch_vectors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "body/pools.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;

using PackedVector = std::array<double, 4>;  // the fourth, as a word: the node or the patch's row

constexpr std::size_t kSumBytes = 2 * sizeof(double);
// Parts hang together by nodes and have an element each.
constexpr std::size_t kNodesOfAPart = 4;

PackedVector pack_vector(const Vec3& v, std::size_t of) {
  // In the lower word of a number near 1, that a device may not take for zero.
  return {v.x(), v.y(), v.z(), std::bit_cast<double>(0x3ff0'0000'0000'0000 | std::uint64_t{of})};
}

std::size_t words_bytes(const std::vector<std::uint32_t>& words) {
  return Buffer::padded(words.size() * sizeof(std::uint32_t));
}

}  // namespace

PatchVectors::PatchVectors(const Problem& problem) : problem_(problem) {
  const fem::Pools* pools = problem.pools();
  if (!pools) return;
  of_node_.resize(problem.mesh().nodes.size());
  std::vector<std::size_t> lengths, of_further;
  const auto count = static_cast<std::uint32_t>(pools->count());
  const std::size_t whole = round_up(count, shaders::kGroup);
  groups_of_whole_ = static_cast<std::uint32_t>(whole / shaders::kGroup);
  for (Index p = 0; p < pools->count(); ++p) {
    Patch& patch = patches_.emplace_back();
    for (Index n : pools->nodes(problem, p)) {
      auto& of = of_node_[static_cast<std::size_t>(n)];
      of.emplace_back(p, patch.entries.size());
      patch.entries.push_back({n, of.size() - 1, {}});
    }
    lengths.push_back(patch.entries.size());
    patch.further = whole + of_further.size();
    of_further.resize(of_further.size() + patch.entries.size() / kNodesOfAPart - 1,
                      patch.entries.size());
  }
  lengths.resize(whole, 0);
  lengths.insert(lengths.end(), of_further.begin(), of_further.end());
  const Slices by_patch(lengths);
  by_patch_ = ReservedSlices(by_patch, [&](std::uint32_t slice) {
    return slice < groups_of_whole_ ? by_patch.width(slice) : 0;
  });
  lengths.clear();
  for (const auto& of : of_node_) lengths.push_back(2 * of.size());
  const Slices by_node(lengths);
  by_node_ = ReservedSlices(by_node, [&](std::uint32_t slice) { return by_node.width(slice) / 2; });
  for (Index p = 0; p < pools->count(); ++p) compute(p, {});
}

PatchVectors::Parts PatchVectors::parts_of(Index patch, const fem::Pools& now) const {
  Parts parts = now.parts_of(*problem_.pools(), patch);
  if (parts.size() == 1) parts.clear();
  return parts;
}

/// Adds v of a part: (kappa / V_p)^1/2 sum a_e V_e grad N with V_p = sum a_e V_e.
void PatchVectors::add(Patch& patch, std::size_t part, std::span<const Index> elements, double bulk,
                       std::span<const double> scale) {
  double volume = 0;
  for (Index e : elements) {
    const TetShape& shape = problem_.shape(e);
    const double own = (scale.empty() ? 1.0 : scale[static_cast<std::size_t>(e)]) * shape.volume;
    volume += own;
    const auto& tet = problem_.mesh().tets[static_cast<std::size_t>(e)];
    for (std::size_t a = 0; a < 4; ++a) {
      auto& values = std::ranges::lower_bound(patch.entries, tet[a], {}, &Entry::node)->values;
      auto value = std::ranges::find(values, part, &Value::part);
      if (value == values.end()) value = std::ranges::find(values, kUnused, &Value::part);
      if (value == values.end()) throw std::logic_error("a node lies in three parts of a patch");
      value->part = part;
      value->v += own * shape.gradient.col(static_cast<Index>(a));
    }
  }
  const double root = std::sqrt(bulk / volume);
  for (Entry& entry : patch.entries) {
    for (Value& value : entry.values) {
      if (value.part == part) value.v *= root;
    }
  }
}

void PatchVectors::compute(Index number, std::span<const double> scale) {
  const fem::Pools& pools = *problem_.pools();
  Patch& patch = patches_[static_cast<std::size_t>(number)];
  for (Entry& entry : patch.entries) entry.values = {};
  if (patch.parts.empty()) add(patch, 0, pools.elements(number), pools.bulk(number), scale);
  if (patch.parts.size() > std::max(patch.entries.size() / kNodesOfAPart, std::size_t{1})) {
    throw std::logic_error("parts of a patch share nodes of live elements");
  }
  for (std::size_t part = 0; part < patch.parts.size(); ++part) {
    add(patch, part, patch.parts[part], pools.bulk(number), scale);
  }
}

void PatchVectors::use_reserve(const Patch& patch, int one) {
  for (std::size_t part = 1; part < patch.parts.size(); ++part) {
    by_patch_.use(patch.further + part - 1, one);
  }
  for (const Entry& entry : patch.entries) {
    if (entry.values[1].part != kUnused) {
      by_node_.use(static_cast<std::size_t>(entry.node), one);
    }
  }
}

std::size_t PatchVectors::row_of(Index patch, std::size_t part) const {
  const auto p = static_cast<std::size_t>(patch);
  return part == 0 ? p : patches_[p].further + part - 1;
}

template <class Put>
void PatchVectors::place(Index number, bool reserve, const Put& put) const {
  const Patch& patch = patches_[static_cast<std::size_t>(number)];
  for (std::size_t part = 0; part < std::max(patch.parts.size(), std::size_t{1}); ++part) {
    const std::size_t row = row_of(number, part);
    std::size_t k = 0, first = 0;
    for (const Entry& entry : patch.entries) {
      for (const Value& value : entry.values) {
        if (value.part != part) continue;
        const auto n = static_cast<std::size_t>(entry.node);
        if (k == 0) first = n;
        put(by_patch_, by_patch_.slices().place(row, k++), value.v, n);
      }
    }
    while (k < patch.entries.size()) {
      put(by_patch_, by_patch_.slices().place(row, k++), Vec3::Zero(), first);
    }
  }
  for (const Entry& entry : patch.entries) {
    const auto n = static_cast<std::size_t>(entry.node);
    const auto& [one, two] = entry.values;
    put(by_node_, by_node_.slices().place(n, entry.at), one.v, row_of(number, one.part));
    if (!reserve) continue;
    put(by_node_, by_node_.place_in_reserve(n, entry.at), two.v,
        two.part == kUnused ? row_of(number, 0) : row_of(number, two.part));
  }
}

std::size_t PatchVectors::planned_bytes() const {
  if (empty()) return 0;
  return (by_patch_.slices().count() + by_node_.slices().count()) * sizeof(PackedVector) +
         words_bytes(by_patch_.ranges()) + words_bytes(by_node_.ranges()) +
         std::size_t{groups()} * shaders::kGroup * kSumBytes;
}

void PatchVectors::upload(const KernelFactory& kernels) {
  if (empty()) return;
  // What pads is 0.
  std::vector<PackedVector> by_patch(by_patch_.slices().count(), pack_vector(Vec3::Zero(), 0)),
      by_node(by_node_.slices().count(), pack_vector(Vec3::Zero(), 0));
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    place(static_cast<Index>(p), false,
          [&](const ReservedSlices& order, std::size_t at, const Vec3& v, std::size_t of) {
            (&order == &by_patch_ ? by_patch : by_node)[at] = pack_vector(v, of);
          });
  }
  const auto upload = [&](Buffer& buffer, const auto& values) {
    buffer = Buffer(kernels.device(), values.size() * sizeof(values[0]), vulkan::Placement::device);
    buffer.write(std::span(values));
  };
  upload(patch_values_, by_patch);
  upload(patch_ranges_, by_patch_.ranges());
  upload(node_values_, by_node);
  upload(node_ranges_, by_node_.ranges());
  sums_ = Buffer(kernels.device(), std::size_t{groups()} * shaders::kGroup * kSumBytes,
                 vulkan::Placement::device);
  sums_.fill_zero();
}

void PatchVectors::destroy(std::span<const Index> elements, std::span<const double> scale,
                           const fem::Pools& now, std::set<Index>& touched) {
  const fem::Pools& pools = *problem_.pools();
  std::vector<Index> own;
  pools.of(elements, own);
  std::set<Index> changed(own.begin(), own.end()), others = split_;
  for (Index further = pools.count(); further < now.count(); ++further) {
    others.insert(pools.of(now.elements(further).front()));
  }
  for (Index p : others) {
    if (parts_of(p, now) != patches_[static_cast<std::size_t>(p)].parts) changed.insert(p);
  }
  const auto before = std::pair(by_patch_.ranges(), by_node_.ranges());
  for (Index p : changed) {
    become(p, parts_of(p, now), scale);
    for (const Entry& of : patches_[static_cast<std::size_t>(p)].entries) touched.insert(of.node);
  }
  if (by_patch_.ranges() != before.first) patch_ranges_.write(std::span(by_patch_.ranges()));
  if (by_node_.ranges() != before.second) node_ranges_.write(std::span(by_node_.ranges()));
}

void PatchVectors::become(Index number, Parts parts, std::span<const double> scale) {
  Patch& patch = patches_[static_cast<std::size_t>(number)];
  const bool reserve = !parts.empty() || !patch.parts.empty();
  use_reserve(patch, -1);
  patch.parts = std::move(parts);
  compute(number, scale);
  use_reserve(patch, 1);
  if (patch.parts.empty()) {
    split_.erase(number);
  } else {
    split_.insert(number);
  }
  place(number, reserve,
        [&](const ReservedSlices& order, std::size_t at, const Vec3& v, std::size_t of) {
          const PackedVector packed = pack_vector(v, of);
          (&order == &by_patch_ ? patch_values_ : node_values_)
              .write(std::span<const double>(packed), at * packed.size());
        });
}

Mat3 PatchVectors::diagonal(Index node) const {
  Mat3 sum = Mat3::Zero();
  if (empty()) return sum;
  for (const auto& [patch, entry] : of_node_[static_cast<std::size_t>(node)]) {
    for (const Value& value : patches_[static_cast<std::size_t>(patch)].entries[entry].values) {
      sum += value.v * value.v.transpose();
    }
  }
  return sum;
}

std::unique_ptr<vulkan::Binding> PatchVectors::bind_sums(const KernelFactory& kernels,
                                                         const vulkan::Kernel& kernel,
                                                         const Buffer& p) const {
  const Buffer* buffers[] = {&patch_values_, &patch_ranges_, &p, &sums_};
  return std::make_unique<vulkan::Binding>(kernels.device(), kernel, buffers);
}

void PatchVectors::append_to(std::vector<const Buffer*>& buffers) const {
  buffers.insert(buffers.end(), {&node_values_, &node_ranges_, &sums_});
}

std::size_t PatchVectors::bytes() const {
  return patch_values_.bytes() + patch_ranges_.bytes() + node_values_.bytes() +
         node_ranges_.bytes() + sums_.bytes();
}

}  // namespace sunder::gpu
