// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/dense_inverse.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "gpu/passes/fields.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Binding;
using vulkan::Buffer;
using vulkan::Placement;

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

std::unique_ptr<Binding> bind_buffers(const KernelFactory& kernels, const vulkan::Kernel& kernel,
                                      std::initializer_list<const Buffer*> list) {
  return std::make_unique<Binding>(kernels.device(), kernel, std::vector<const Buffer*>(list));
}

constexpr std::size_t kFirstEntries = 64;

/// The dense product's vector comes in fp64 and is read in fp32.
bool narrows(const KernelFactory& kernels) { return !kernels.fp64() && !kernels.single(); }

/// Columns of the largest panel that a device takes. Throws DeviceError when it takes none.
std::uint32_t panel_columns(const KernelFactory& kernels, std::uint32_t rows,
                            std::size_t panel_bytes) {
  const vulkan::PhysicalDevice& device = kernels.device().physical();
  const std::size_t column_bytes = rows * kernels.real_bytes();
  const std::size_t limit = std::min<std::size_t>(
      {device.limits.buffer_bytes.value, device.limits.allocation_bytes.value,
       device.limits.texels.value * 16, panel_bytes > 0 ? panel_bytes : SIZE_MAX});
  const std::size_t most = limit / column_bytes / shaders::kColumnPad * shaders::kColumnPad;
  if (most == 0) {
    throw DeviceError("the device \"" + device.name + "\" takes buffers of " +
                      std::to_string(limit) + " bytes, but 64 columns of the inverse need " +
                      std::to_string(64 * column_bytes) + "; use route cg");
  }
  return u32(std::min<std::size_t>(most, UINT32_MAX / shaders::kColumnPad * shaders::kColumnPad));
}

}  // namespace

PartialSums::PartialSums(const KernelFactory& kernels, std::uint32_t rows, std::uint32_t chunks)
    : kernels_(kernels), rows_(rows), sum_(kernels.make_fp64("sum")) {
  reserve(chunks);
}

bool PartialSums::reserve(std::uint32_t chunks) {
  if (chunks <= chunks_) return false;
  chunks_ = chunks;
  buffer_ =
      Buffer(kernels_.device(), std::size_t{chunks} * rows_ * sizeof(double), Placement::device);
  return true;
}

std::unique_ptr<Binding> PartialSums::bind_sum(const Buffer& positions, const Buffer& nodal) const {
  return bind_buffers(kernels_, *sum_, {&buffer_, &positions, &nodal});
}

void PartialSums::record_sum(vulkan::Commands& commands, const Binding& into, std::uint32_t chunks,
                             bool add) const {
  commands.dispatch(into, shaders::SumPush{rows_ / 4, chunks, add ? 1u : 0u},
                    rows_ / shaders::kRowPad);
}

DenseInverse::DenseInverse(const KernelFactory& kernels, Shape shape, std::uint32_t rows,
                           std::size_t panel_bytes)
    : kernels_(kernels),
      n_(shape.n),
      rows_(rows),
      columns_(round_up(u32(shape.columns), shaders::kColumnPad)) {
  create_panels(panel_bytes);
  create_apply();
  if (narrows(kernels)) {
    vector_ = Buffer(kernels_.device(), rows_ * sizeof(float), Placement::device);
  }
  entries_ = Buffer(kernels_.device(), kFirstEntries * sizeof(shaders::Entry), Placement::sent);
}

DenseInverse::Planned DenseInverse::planned(const KernelFactory& kernels, Shape shape,
                                            std::uint32_t rows, std::size_t panel_bytes) {
  const std::uint32_t columns = round_up(u32(shape.columns), shaders::kColumnPad);
  const std::uint32_t most = panel_columns(kernels, rows, panel_bytes);
  return {std::size_t{columns} * rows * kernels.real_bytes() +
              Buffer::padded(kFirstEntries * sizeof(shaders::Entry)) +
              (narrows(kernels) ? rows * sizeof(float) : 0),
          (columns - 1) / most + 1, columns / shaders::kChunk};
}

void DenseInverse::create_panels(std::size_t panel_bytes) {
  const std::size_t column_bytes = rows_ * kernels_.real_bytes();
  const std::uint32_t most = panel_columns(kernels_, rows_, panel_bytes);
  for (std::uint32_t first = 0; first < columns_;) {
    Panel panel;
    panel.first = first;
    panel.columns = std::min(most, columns_ - first);
    panel.matrix = Buffer(kernels_.device(), panel.columns * column_bytes, Placement::device);
    first += panel.columns;
    panels_.push_back(std::move(panel));
  }
}

std::size_t DenseInverse::panel_of(Index column) const {
  const auto found = std::ranges::find_if(panels_, [&](const Panel& panel) {
    return u32(column) >= panel.first && u32(column) < panel.first + panel.columns;
  });
  return static_cast<std::size_t>(found - panels_.begin());
}

void DenseInverse::create_apply() {
  apply_ = kernels_.make("apply", shaders::kGroup, lower_ ? 1 : 0);
}

/// Whether to read the lower tiles alone: kernels that read them are others.
void DenseInverse::trust(bool lower_alone) {
  if (lower_ == lower_alone) return;
  lower_ = lower_alone;
  for (Panel& panel : panels_) {
    panel.loaded.reset();
    panel.dense.reset();
    panel.vectors.reset();
  }
  dense_.reset();
  vectors_.reset();
  create_apply();
  if (partials_) bind_loaded();
}

void DenseInverse::upload(const Columns& columns) {
  trust(false);
  // Columns at a time: through staging memory in large pieces, else as the host's cache holds them.
  const Index most = kernels_.device().physical().unified() ? 32 : 256;
  for (Panel& panel : panels_) {
    const Index end = std::min(n_, static_cast<Index>(panel.first + panel.columns));
    for (Index c = static_cast<Index>(panel.first); c < end; c += most) {
      write_columns(c, columns(c, std::min(most, end - c)));
    }
    const std::size_t column_bytes = rows_ * kernels_.real_bytes();
    const std::size_t filled = column_bytes * (static_cast<std::size_t>(end) - panel.first);
    panel.matrix.fill_zero(filled, panel.matrix.bytes() - filled);
  }
}

void DenseInverse::write_columns(Index first, const Eigen::MatrixXd& columns) {
  Panel& panel = panels_[panel_of(first)];
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(static_cast<Index>(rows_), columns.cols());
  block.topRows(n_) = columns;
  const std::size_t at = (static_cast<std::size_t>(first) - panel.first) * rows_;
  const std::size_t size = static_cast<std::size_t>(block.size());
  if (kernels_.fp64()) {
    panel.matrix.write(std::span<const double>(block.data(), size), at);
  } else {
    const Eigen::MatrixXf rounded = block.cast<float>();
    panel.matrix.write(std::span<const float>(rounded.data(), size), at);
  }
}

void DenseInverse::write_column(Index column, std::span<const double> values) {
  Panel& panel = panels_[panel_of(column)];
  panel.matrix.write(values, (static_cast<std::size_t>(column) - panel.first) * rows_);
}

void DenseInverse::bind(const PartialSums& partials, const Buffer& vector) {
  partials_ = &partials;
  dense_vector_ = &vector;
  for (Panel& panel : panels_) panel.dense.reset();
  bind_loaded();
}

/// Update eager alone needs it, for its estimate of the error.
void DenseInverse::create_dense() {
  const bool narrow = narrows(kernels_);
  if (!dense_) {
    dense_ = kernels_.make("dense", shaders::kGroup, lower_ ? 1 : 0);
    if (narrow && !narrow_) {
      narrow_ = kernels_.make_fp64("narrow");
    }
  }
  if (narrow) narrowing_ = bind_buffers(kernels_, *narrow_, {dense_vector_, &vector_});
  const Buffer* read = narrow ? &vector_ : dense_vector_;
  for (Panel& panel : panels_) {
    panel.dense = bind_buffers(kernels_, *dense_, {&panel.matrix, read, &partials_->buffer()});
  }
}

void DenseInverse::bind_loaded() {
  for (Panel& panel : panels_) {
    panel.loaded =
        bind_buffers(kernels_, *apply_, {&panel.matrix, &entries_, &partials_->buffer()});
  }
}

std::uint32_t DenseInverse::loaded_chunks(const Loaded& load) const {
  return u32(load.dofs.size() / shaders::kChunk + panels_.size());
}

shaders::Entry DenseInverse::entry_of(std::uint32_t column, double value) const {
  if (kernels_.single()) {  // two floats (shaders/apply.comp)
    const auto high = static_cast<float>(value);
    const auto low = static_cast<float>(value - static_cast<double>(high));
    return {column, 0, std::bit_cast<std::uint32_t>(high), std::bit_cast<std::uint32_t>(low)};
  }
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return {column, 0, static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

void DenseInverse::reserve_loaded(std::size_t dofs) {
  if (dofs * sizeof(shaders::Entry) <= entries_.bytes()) return;
  entries_ = Buffer(kernels_.device(), dofs * sizeof(shaders::Entry), Placement::sent);
  if (partials_) bind_loaded();
}

std::size_t DenseInverse::planned_loaded(std::size_t dofs) {
  return dofs <= kFirstEntries ? 0
                               : Buffer::padded(dofs * sizeof(shaders::Entry)) -
                                     Buffer::padded(kFirstEntries * sizeof(shaders::Entry));
}

void DenseInverse::set_loaded(const Loaded& load) {
  if (load.dofs.size() * sizeof(shaders::Entry) > entries_.bytes()) {
    reserve_loaded(2 * load.dofs.size());
  }
  auto* entry = entries_.mapped<shaders::Entry>();
  std::uint32_t next = 0;
  for (Panel& panel : panels_) {
    panel.first_entry = next;
    while (next < load.dofs.size() && u32(load.dofs[next]) < panel.first + panel.columns) {
      entry[next] = entry_of(u32(load.dofs[next]), load.values[next]);
      ++next;
    }
    panel.last_entry = next;
  }
}

std::uint32_t DenseInverse::record_loaded(vulkan::Commands& commands,
                                          std::uint32_t first_chunk) const {
  std::uint32_t chunk = first_chunk;
  const std::uint32_t all = panels_.back().last_entry;
  for (const Panel& panel : panels_) {
    // Of the lower tiles every panel has a share in every column, added to the same sums.
    const std::uint32_t first = lower_ ? 0 : panel.first_entry;
    const std::uint32_t last = lower_ ? all : panel.last_entry;
    if (first == last) continue;
    const bool add = lower_ && panel.first > 0;
    if (!add) commands.apart();  // chunks of its own
    const std::uint32_t groups = round_up(last - first, shaders::kChunk) / shaders::kChunk;
    commands.dispatch(*panel.loaded,
                      shaders::ApplyPush{rows_ / 4, first, last, 0, lower_ ? first_chunk : chunk,
                                         panel.first, panel.columns, add ? 1u : 0u},
                      rows_ / shaders::kRowPad, groups);
    chunk = lower_ ? first_chunk + groups : chunk + groups;
  }
  return chunk - first_chunk;
}

std::uint32_t DenseInverse::record_dense(vulkan::Commands& commands, std::uint32_t first_chunk) {
  if (!panels_.front().dense) create_dense();
  if (narrowing_) commands.dispatch(*narrowing_, rows_ / shaders::kRowPad);
  for (const Panel& panel : panels_) {
    const std::uint32_t tile = panel.first / shaders::kTile;
    const bool add = lower_ && panel.first > 0;
    if (!add) commands.apart();
    commands.dispatch(
        *panel.dense,
        shaders::ApplyPush{rows_ / 4, lower_ ? tile : 0, 0, lower_ ? 0 : panel.first / 4,
                           first_chunk + tile, panel.first, panel.columns, add ? 1u : 0u},
        rows_ / shaders::kRowPad, lower_ ? chunks() - tile : panel.columns / shaders::kChunk);
  }
  return chunks();
}

std::size_t DenseInverse::planned_pick(std::size_t rows, std::size_t columns) {
  return Buffer::padded(2 * (rows + columns) * 4) + Buffer::padded(2 * rows * columns * 8);
}

std::size_t DenseInverse::planned_update(const KernelFactory& kernels, std::uint32_t rows,
                                         std::uint32_t dofs, std::uint32_t rank) {
  const std::size_t padded_rank = round_up(rank, shaders::kRankBlock);
  return Buffer::padded(dofs * sizeof(Index)) +
         Buffer::padded(dofs * padded_rank / shaders::kRankBlock * 8 * sizeof(double)) +
         Buffer::padded(padded_rank * rows * kernels.real_bytes());
}

void DenseInverse::reserve_pick(std::size_t dofs, std::size_t values) {
  if (!pick_) {
    pick_ = kernels_.make("pick");
  } else if (dofs * 4 <= pick_dofs_.bytes() && values * 8 <= picked_.bytes()) {
    return;
  }
  for (Panel& panel : panels_) panel.pick.reset();
  pick_dofs_ = Buffer(kernels_.device(), 2 * dofs * 4, Placement::sent);
  picked_ = Buffer(kernels_.device(), 2 * values * 8, Placement::host);
  for (Panel& panel : panels_) {
    panel.pick = bind_buffers(kernels_, *pick_, {&panel.matrix, &pick_dofs_, &picked_});
  }
}

Eigen::MatrixXd DenseInverse::pick(std::span<const Index> rows, std::span<const Index> columns) {
  const std::size_t values = rows.size() * columns.size();
  if (values == 0) {
    return Eigen::MatrixXd(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  }
  reserve_pick(rows.size() + columns.size(), values);
  auto* dofs = pick_dofs_.mapped<Index>();
  std::copy(columns.begin(), columns.end(), std::copy(rows.begin(), rows.end(), dofs));
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  for (const Panel& panel : panels_) {
    commands.apart();  // the panel's own columns
    commands.dispatch(
        *panel.pick,
        shaders::PickPush{u32(rows.size()), u32(columns.size()), panel.first, panel.columns, rows_},
        round_up(u32(rows.size()), shaders::kGroup) / shaders::kGroup, u32(columns.size()));
  }
  commands.end();
  commands.submit();
  return Eigen::Map<const Eigen::MatrixXd>(picked_.mapped<double>(),
                                           static_cast<Index>(rows.size()),
                                           static_cast<Index>(columns.size()));
}

void DenseInverse::reserve_update(std::size_t dofs, std::uint32_t blocks) {
  const std::size_t factor_bytes = dofs * blocks * 8 * sizeof(double);
  const std::size_t z_bytes =
      std::size_t{blocks} * shaders::kRankBlock * rows_ * kernels_.real_bytes();
  if (!vectors_) {
    vectors_ = kernels_.make("update_vectors", shaders::kGroup, lower_ ? 1 : 0);
  } else if (dofs * 4 <= update_dofs_.bytes() && factor_bytes <= factors_.bytes() &&
             z_bytes <= z_.bytes()) {
    return;
  }
  for (Panel& panel : panels_) {
    panel.vectors.reset();
    panel.low_rank.reset();
    panel.rank_6.reset();
  }
  update_dofs_ = Buffer(kernels_.device(), dofs * 4, Placement::sent);
  factors_ = Buffer(kernels_.device(), factor_bytes, Placement::device);
  z_ = Buffer(kernels_.device(), z_bytes, Placement::device);
  for (Panel& panel : panels_) {
    panel.vectors =
        bind_buffers(kernels_, *vectors_, {&panel.matrix, &update_dofs_, &factors_, &z_});
  }
}

void DenseInverse::bind_update(std::uint32_t blocks) {
  auto& kernel = blocks == 1 ? rank_6_ : low_rank_;
  if (!kernel) {
    kernel = kernels_.make("low_rank", kernels_.low_rank_group(), blocks == 1 ? 1 : 0);
  }
  for (Panel& panel : panels_) {
    auto& binding = blocks == 1 ? panel.rank_6 : panel.low_rank;
    if (!binding) binding = bind_buffers(kernels_, *kernel, {&panel.matrix, &z_, &panel.matrix});
  }
}

void DenseInverse::write_factors(const Eigen::MatrixXd& v, std::uint32_t blocks) {
  std::vector<double> packed(static_cast<std::size_t>(v.rows()) * blocks * 8, 0.0);
  for (Index t = 0; t < v.rows(); ++t) {
    for (Index r = 0; r < v.cols(); ++r) {
      packed[(static_cast<std::size_t>(t) * blocks + r / shaders::kRankBlock) * 8 +
             r % shaders::kRankBlock] = v(t, r);
    }
  }
  factors_.write(std::span<const double>(packed));
}

void DenseInverse::record_vectors(vulkan::Commands& commands, std::span<const Index> dofs,
                                  std::uint32_t blocks) const {
  bool add = false;
  for (const Panel& panel : panels_) {
    commands.dispatch(*panel.vectors,
                      shaders::VectorsPush{rows_ / 4, 0, u32(dofs.size()), blocks, panel.first,
                                           panel.columns, add ? 1u : 0u},
                      rows_ / shaders::kRowPad, blocks);
    add = true;
  }
}

void DenseInverse::update(std::span<const Index> dofs, const Eigen::MatrixXd& v, float sign) {
  const std::uint32_t blocks = round_up(u32(v.cols()), shaders::kRankBlock) / shaders::kRankBlock;
  trust(true);
  reserve_update(dofs.size(), blocks);
  bind_update(blocks);
  std::copy(dofs.begin(), dofs.end(), update_dofs_.mapped<Index>());
  write_factors(v, blocks);
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  commands.pass("update");
  record_vectors(commands, dofs, blocks);
  for (const Panel& panel : panels_) record_low_rank(commands, panel, blocks, sign);
  commands.end();
  commands.submit();
}

void DenseInverse::record_low_rank(vulkan::Commands& commands, const Panel& panel,
                                   std::uint32_t blocks, float sign) const {
  const std::uint32_t rows = (columns_ - panel.first) / shaders::kTile;
  const std::uint32_t columns = panel.columns / shaders::kTile;
  const std::uint32_t groups = (columns * rows - columns * (columns - 1) / 2) *
                               (shaders::kTile / kernels_.low_rank_columns(blocks == 1));
  commands.dispatch(blocks == 1 ? *panel.rank_6 : *panel.low_rank,
                    shaders::LowRankPush{rows_ / 4, blocks, panel.first, rows, sign}, groups);
}

/// What the complement's kernel needs beside the panels.
void DenseInverse::scale_by(std::span<const double> scales) {
  complement_ = kernels_.make("complement");
  std::vector<double> padded(std::max(rows_, columns_), 0.0);
  std::ranges::copy(scales, padded.begin());
  scales_ = Buffer(kernels_.device(), padded.size() * sizeof(double), Placement::staging);
  scales_.write(std::span<const double>(padded));
}

void DenseInverse::add_passages(const DenseInverse& other, std::uint32_t left_out, bool mirror,
                                std::vector<Passage>& to) const {
  for (const Panel& from : other.panels_) {
    for (const Panel& panel : panels_) {
      if (left_out == shaders::kUpperTiles && from.first != panel.first) continue;
      to.push_back({bind_buffers(kernels_, *complement_, {&from.matrix, &scales_, &panel.matrix}),
                    {rows_ / 4, from.first, from.columns, panel.first, left_out, mirror ? 1u : 0u},
                    panel.columns});
    }
  }
}

void DenseInverse::record(vulkan::Commands& commands, std::span<const Passage> passages) const {
  for (const Passage& p : passages) {
    commands.dispatch(*p.binding, p.push, rows_ / shaders::kRowPad, p.columns);
  }
}

void DenseInverse::take_complement(const DenseInverse& other, std::span<const double> scales) {
  scale_by(scales);
  std::vector<Passage> passages;
  if (&other == this) {
    add_passages(other, shaders::kLowerTiles, false, passages);
    add_passages(other, shaders::kUpperTiles, false, passages);
  } else {
    add_passages(other, 0, false, passages);
  }
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  record(commands, passages);
  commands.end();
  commands.submit();
  passages.clear();
  mirror_.clear();
  complement_.reset();
  scales_ = Buffer();
  release_room();
  trust(false);
}

std::vector<DenseInverse::Part> DenseInverse::parts() const {
  std::vector<Part> parts;
  for (const Panel& panel : panels_) parts.push_back({&panel.matrix, panel.first, panel.columns});
  return parts;
}

void DenseInverse::prepare_mirror() {
  scale_by(std::vector<double>(static_cast<std::size_t>(n_), 1.0));
  mirror_.clear();
  add_passages(*this, shaders::kLowerTiles, true, mirror_);
}

void DenseInverse::record_mirror(vulkan::Commands& commands) const { record(commands, mirror_); }

void DenseInverse::swap(DenseInverse& other) {
  for (DenseInverse* one : {this, &other}) {
    for (Panel& panel : one->panels_) {
      panel.loaded.reset();
      panel.dense.reset();
    }
    one->release_room();
  }
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    std::swap(panels_[i].matrix, other.panels_[i].matrix);
  }
  for (DenseInverse* one : {this, &other}) {
    if (one->partials_) one->bind_loaded();
    if (one->mirror_.empty()) continue;
    one->mirror_.clear();
    one->add_passages(*one, shaders::kLowerTiles, true, one->mirror_);
  }
}

/// What pick() and update() work with comes back with the next of them.
void DenseInverse::release_room() {
  for (Panel& panel : panels_) {
    panel.pick.reset();
    panel.vectors.reset();
    panel.low_rank.reset();
    panel.rank_6.reset();
  }
  pick_.reset();
  vectors_.reset();
  for (Buffer* room : {&pick_dofs_, &picked_, &update_dofs_, &factors_, &z_}) *room = Buffer();
}

void DenseInverse::read_columns(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> to) const {
  std::vector<Buffer::Part> parts;
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const Panel& panel = panels_[panel_of(dofs[i])];
    const std::size_t at = std::size_t{u32(dofs[i]) - panel.first} * rows_;
    const std::span column(to.col(static_cast<Index>(i)).data(), static_cast<std::size_t>(n_));
    parts.emplace_back(panel.matrix, at, column);
  }
  Buffer::read_all(parts);
}

std::size_t DenseInverse::bytes() const {
  std::size_t bytes = 0;
  for (const Panel& panel : panels_) bytes += panel.matrix.bytes();
  return bytes;
}

}  // namespace sunder::gpu
