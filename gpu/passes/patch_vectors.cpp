// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/patch_vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "body/pools.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;

using PackedVector = std::array<double, 4>;  // the fourth: the node or the patch, exact

PackedVector pack_vector(const Vec3& v, std::size_t of) {
  return {v.x(), v.y(), v.z(), static_cast<double>(of)};
}

constexpr std::size_t kSumBytes = 2 * sizeof(double);

}  // namespace

PatchVectors::PatchVectors(const Problem& problem) : problem_(problem) {
  const fem::Pools* pools = problem.pools();
  if (!pools) return;
  of_node_.resize(problem.mesh().nodes.size());
  std::vector<std::size_t> lengths;
  for (Index p = 0; p < pools->count(); ++p) {
    for (Index n : pools->nodes(problem, p)) {
      auto& of = of_node_[static_cast<std::size_t>(n)];
      row_.push_back(of.size());
      of.push_back(nodes_.size());
      nodes_.push_back(n);
    }
    lengths.push_back(nodes_.size() - begin_.back());
    begin_.push_back(nodes_.size());
  }
  values_.resize(nodes_.size());
  by_patch_ = Slices(lengths);
  lengths.clear();
  for (const auto& of : of_node_) lengths.push_back(of.size());
  by_node_ = Slices(lengths);
  for (Index p = 0; p < pools->count(); ++p) compute(p, {});
}

/// v of a patch: (kappa / V_p)^1/2 sum a_e V_e grad N with V_p = sum a_e V_e.
void PatchVectors::compute(Index patch, std::span<const double> scale) {
  const fem::Pools& pools = *problem_.pools();
  const auto p = static_cast<std::size_t>(patch);
  const std::span nodes = std::span(nodes_).subspan(begin_[p], begin_[p + 1] - begin_[p]);
  const std::span values = std::span(values_).subspan(begin_[p], nodes.size());
  std::ranges::fill(values, Vec3::Zero());
  double volume = 0;
  for (Index e : pools.elements(patch)) {
    const TetShape& shape = problem_.shape(e);
    const double own = (scale.empty() ? 1.0 : scale[static_cast<std::size_t>(e)]) * shape.volume;
    volume += own;
    const auto& tet = problem_.mesh().tets[static_cast<std::size_t>(e)];
    for (std::size_t a = 0; a < 4; ++a) {
      const auto at = std::ranges::lower_bound(nodes, tet[a]) - nodes.begin();
      values[static_cast<std::size_t>(at)] += own * shape.gradient.col(static_cast<Index>(a));
    }
  }
  const double root = std::sqrt(pools.bulk(patch) / volume);
  for (Vec3& v : values) v *= root;
}

std::size_t PatchVectors::planned_bytes() const {
  if (empty()) return 0;
  return (by_patch_.count() + by_node_.count()) * sizeof(PackedVector) +
         Buffer::padded(by_patch_.bytes()) + Buffer::padded(by_node_.bytes()) +
         std::size_t{groups()} * shaders::kGroup * kSumBytes;
}

void PatchVectors::upload(const KernelFactory& kernels) {
  if (empty()) return;
  // What pads is 0.
  std::vector<PackedVector> by_patch(by_patch_.count(), pack_vector(Vec3::Zero(), 0)),
      by_node(by_node_.count(), pack_vector(Vec3::Zero(), 0));
  for (std::size_t p = 0; p + 1 < begin_.size(); ++p) {
    for (std::size_t i = begin_[p]; i < begin_[p + 1]; ++i) {
      const auto n = static_cast<std::size_t>(nodes_[i]);
      by_patch[by_patch_.place(p, i - begin_[p])] = pack_vector(values_[i], n);
      by_node[by_node_.place(n, row_[i])] = pack_vector(values_[i], p);
    }
  }
  const auto upload = [&](Buffer& buffer, const auto& values) {
    buffer = Buffer(kernels.device(), values.size() * sizeof(values[0]), vulkan::Placement::device);
    buffer.write(std::span(values));
  };
  upload(patches_, by_patch);
  upload(patch_slices_, by_patch_.first());
  upload(nodal_, by_node);
  upload(nodal_slices_, by_node_.first());
  sums_ = Buffer(kernels.device(), std::size_t{groups()} * shaders::kGroup * kSumBytes,
                 vulkan::Placement::device);
}

void PatchVectors::destroy(std::span<const Index> elements, std::span<const double> scale,
                           std::set<Index>& touched) {
  if (empty()) return;
  std::vector<Index> patches;
  problem_.pools()->of(elements, patches);
  for (Index patch : patches) {
    compute(patch, scale);
    write(patch);
    const auto p = static_cast<std::size_t>(patch);
    touched.insert(&nodes_[begin_[p]], &nodes_[begin_[p]] + (begin_[p + 1] - begin_[p]));
  }
}

void PatchVectors::write(Index patch) {
  const auto p = static_cast<std::size_t>(patch);
  const auto put = [](Buffer& buffer, std::size_t at, const PackedVector& value) {
    buffer.write(std::span<const double>(value), at * value.size());
  };
  for (std::size_t i = begin_[p]; i < begin_[p + 1]; ++i) {
    const auto n = static_cast<std::size_t>(nodes_[i]);
    put(patches_, by_patch_.place(p, i - begin_[p]), pack_vector(values_[i], n));
    put(nodal_, by_node_.place(n, row_[i]), pack_vector(values_[i], p));
  }
}

Mat3 PatchVectors::diagonal(Index node) const {
  Mat3 sum = Mat3::Zero();
  if (empty()) return sum;
  for (const std::size_t i : of_node_[static_cast<std::size_t>(node)]) {
    sum += values_[i] * values_[i].transpose();
  }
  return sum;
}

std::unique_ptr<vulkan::Binding> PatchVectors::bind_sums(const KernelFactory& kernels,
                                                         const vulkan::Kernel& kernel,
                                                         const Buffer& p) const {
  const Buffer* buffers[] = {&patches_, &patch_slices_, &p, &sums_};
  return std::make_unique<vulkan::Binding>(kernels.device(), kernel, buffers);
}

void PatchVectors::append_to(std::vector<const Buffer*>& buffers) const {
  buffers.insert(buffers.end(), {&nodal_, &nodal_slices_, &sums_});
}

std::size_t PatchVectors::bytes() const {
  return patches_.bytes() + patch_slices_.bytes() + nodal_.bytes() + nodal_slices_.bytes() +
         sums_.bytes();
}

}  // namespace sunder::gpu
