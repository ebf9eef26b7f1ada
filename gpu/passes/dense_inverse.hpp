// SPDX-License-Identifier: Apache-2.0
// A dense inverse on the device, in panels of columns so that no buffer exceeds the device's
// limits: u = X f for few loaded dofs and for all, and the eager update X += Z Z^T.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"
#include "shaders/layout.h"
#include "sunder/backend.hpp"

namespace sunder::gpu {

/// Sums of 64 columns each that `sum` adds up in order; shared by all who take part in u = X f.
class PartialSums {
 public:
  PartialSums(const KernelFactory& kernels, std::uint32_t rows, std::uint32_t chunks = 0);
  /// Room for so many chunks. Returns true when the buffer moved: bind anew.
  bool reserve(std::uint32_t chunks);
  [[nodiscard]] const vulkan::Buffer& buffer() const { return buffer_; }
  [[nodiscard]] std::uint32_t chunks() const { return chunks_; }
  /// field (+)= sum of the first `chunks`.
  void record_sum(vulkan::Commands& commands, const vulkan::Binding& into, std::uint32_t chunks,
                  bool add) const;
  [[nodiscard]] std::unique_ptr<vulkan::Binding> bind_sum(const vulkan::Buffer& positions,
                                                          const vulkan::Buffer& nodal) const;

 private:
  const KernelFactory& kernels_;
  std::uint32_t rows_, chunks_ = 0;
  vulkan::Buffer buffer_;
  std::unique_ptr<vulkan::Kernel> sum_;
};

/// Loaded dofs, ascending, and what they carry.
struct Loaded {
  std::vector<Index> dofs;
  std::vector<double> values;
};

class DenseInverse {
 public:
  /// Columns [first, first + count) of a matrix, shape (n x count).
  using Columns = std::function<Eigen::MatrixXd(Index first, Index count)>;

  /// Unknowns, and columns that there is room for: all n, or those that somebody writes one by one.
  struct Shape {
    Shape(Index unknowns) : n(unknowns), columns(unknowns) {}
    Shape(Index unknowns, Index of_them) : n(unknowns), columns(of_them) {}
    Index n, columns;
  };

  /// `panel_bytes`: largest buffer wanted, 0: the device's limit. Throws DeviceError, before
  /// anything is allocated, when the device cannot hold it.
  DenseInverse(const KernelFactory& kernels, Shape shape, std::uint32_t rows,
               std::size_t panel_bytes);

  /// Bytes of an inverse to come, and in how many panels.
  struct Planned {
    std::size_t bytes = 0;
    std::uint32_t panels = 0, chunks = 0;
  };
  [[nodiscard]] static Planned planned(const KernelFactory& kernels, Shape shape,
                                       std::uint32_t rows, std::size_t panel_bytes);

  /// Bytes that the first pick() of such a block takes.
  [[nodiscard]] static std::size_t planned_pick(std::size_t rows, std::size_t columns);
  /// Of update() by a V of this shape.
  [[nodiscard]] static std::size_t planned_update(const KernelFactory& kernels, std::uint32_t rows,
                                                  std::uint32_t dofs, std::uint32_t rank);

  /// Fills the matrix from the host.
  void upload(const Columns& columns);
  /// Some columns, shape (n x columns), that lie in one panel, in place of what is there.
  void write_columns(Index first, const Eigen::MatrixXd& columns);
  /// One column of n, where X is stored in fp64.
  void write_column(Index column, std::span<const double> values);

  [[nodiscard]] std::uint32_t chunks() const { return columns_ / shaders::kChunk; }
  /// Chunks that record_loaded() needs for a load.
  [[nodiscard]] std::uint32_t loaded_chunks(const Loaded& load) const;
  void bind(const PartialSums& partials, const vulkan::Buffer& vector);

  /// Room for loads of so many dofs, and the bytes that it takes beside planned().
  void reserve_loaded(std::size_t dofs);
  [[nodiscard]] static std::size_t planned_loaded(std::size_t dofs);
  /// Writes a load for record_loaded().
  void set_loaded(const Loaded& load);
  /// partials from `first_chunk` on = X f of that load; returns how many.
  std::uint32_t record_loaded(vulkan::Commands& commands, std::uint32_t first_chunk) const;
  /// partials from `first_chunk` on = X times the bound vector; returns how many.
  std::uint32_t record_dense(vulkan::Commands& commands, std::uint32_t first_chunk);

  /// X(rows, columns) as it stands on the device.
  [[nodiscard]] Eigen::MatrixXd pick(std::span<const Index> rows, std::span<const Index> columns);
  /// X += sign Z Z^T with Z = X(:, dofs) V; V: shape (dofs x rank). From then on the tiles over the
  /// diagonal are out of date, and whatever reads X reads the lower ones (shaders/lower.glsl).
  void update(std::span<const Index> dofs, const Eigen::MatrixXd& v, float sign = 1);
  /// X = S (I - other) S, S the diagonal matrix of the scales, positive ones; `other` in fp64, of
  /// the same size, which may be this one.
  void take_complement(const DenseInverse& other, std::span<const double> scales);
  /// Its panels, for whoever multiplies by them.
  struct Part {
    const vulkan::Buffer* matrix;
    std::uint32_t first, columns;
  };
  [[nodiscard]] std::vector<Part> parts() const;
  /// Makes ready for record_mirror().
  void prepare_mirror();
  /// The tiles over the diagonal from those under it, after somebody else has written these.
  void record_mirror(vulkan::Commands& commands) const;
  /// Changes matrices with another of the same size, both whole.
  void swap(DenseInverse& other);
  /// Columns of X, stored in fp64 and not updated, into `to`, shape (n x dofs): a submit where the
  /// memory is not mapped.
  void read_columns(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> to) const;

  [[nodiscard]] bool fp64() const { return kernels_.fp64(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Panel {
    std::uint32_t first = 0, columns = 0;
    vulkan::Buffer matrix;
    std::unique_ptr<vulkan::Binding> loaded, dense, pick, vectors, low_rank, rank_6;
    std::uint32_t first_entry = 0, last_entry = 0;
  };

  /// How take_complement() and record_mirror() go from panel to panel.
  struct Passage {
    std::unique_ptr<vulkan::Binding> binding;
    shaders::ComplementPush push;
    std::uint32_t columns;
  };
  void create_panels(std::size_t panel_bytes);
  /// Which of panels_ has it.
  [[nodiscard]] std::size_t panel_of(Index column) const;
  void scale_by(std::span<const double> scales);
  void add_passages(const DenseInverse& other, std::uint32_t left_out, bool mirror,
                    std::vector<Passage>& to) const;
  void record(vulkan::Commands& commands, std::span<const Passage> passages) const;
  void create_apply();
  void trust(bool lower_alone);
  void release_room();
  void record_low_rank(vulkan::Commands& commands, const Panel& panel, std::uint32_t blocks,
                       float sign) const;
  void bind_loaded();
  [[nodiscard]] shaders::Entry entry_of(std::uint32_t column, double value) const;
  void reserve_pick(std::size_t dofs, std::size_t values);
  void create_dense();
  void bind_update(std::uint32_t blocks);
  void reserve_update(std::size_t dofs, std::uint32_t blocks);
  void write_factors(const Eigen::MatrixXd& v, std::uint32_t blocks);
  void record_vectors(vulkan::Commands& commands, std::span<const Index> dofs,
                      std::uint32_t blocks) const;

  const KernelFactory& kernels_;
  Index n_;
  std::uint32_t rows_, columns_;
  bool lower_ = false;  // tiles over the diagonal are out of date
  std::vector<Panel> panels_;
  const PartialSums* partials_ = nullptr;
  const vulkan::Buffer* dense_vector_ = nullptr;
  std::unique_ptr<vulkan::Kernel> apply_, narrow_, dense_, pick_, vectors_, low_rank_, rank_6_,
      complement_;
  vulkan::Buffer scales_;                       // that complement_ reads
  std::vector<Passage> mirror_;                 // empty: not prepared
  std::unique_ptr<vulkan::Binding> narrowing_;  // empty: the vector has storage precision
  vulkan::Buffer vector_, entries_, pick_dofs_, picked_, update_dofs_, factors_, z_;
};

}  // namespace sunder::gpu
