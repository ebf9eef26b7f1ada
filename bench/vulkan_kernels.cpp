// SPDX-License-Identifier: Apache-2.0
// Single kernels, on a GPU by its own clock: low-rank update, dense and few-column products, stress
// and residual. Traffic is what an ideal cache would leave: every input read
// once, every result written once.
#include <cmath>
#include <map>
#include <numeric>

#include "body/assembly.hpp"
#include "body/stress_summary.hpp"
#include "cpu_reference/stress.hpp"
#include "gpu/passes/dense_inverse.hpp"
#include "gpu/passes/fields.hpp"
#include "support/structured_board.hpp"
#include "vulkan_rows.hpp"

namespace sunder::bench {
namespace {

using gpu::DenseInverse;
using gpu::Fields;

constexpr Index kReferenceLimit = 6000;  // unknowns up to which the host holds a dense matrix too

/// Values of no meaning: a kernel's time does not depend on them.
double value_at(Index i, Index j) { return 1e-3 * ((7 * i + 7 * j + i * j) % 97 - 48); }

Eigen::MatrixXd values(Index rows, Index first, Index columns) {
  Eigen::MatrixXd m(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    for (Index i = 0; i < rows; ++i) m(i, j) = value_at(i, first + j);
  }
  return m;
}

struct Inverse {
  Inverse(const Gpu& g, bool fp64, Index size)
      : n(size),
        rows(gpu::round_up(static_cast<std::uint32_t>(size), shaders::kRowPad)),
        matrix(g.kernels(fp64), size, rows, 0) {
    matrix.upload([&](Index first, Index count) { return values(n, first, count); });
  }
  [[nodiscard]] double entries() const { return static_cast<double>(n) * static_cast<double>(n); }
  Index n;
  std::uint32_t rows;
  DenseInverse matrix;
};

std::string precision(bool fp64) { return fp64 ? "fp64" : "fp32"; }
double real_bytes(bool fp64) { return fp64 ? 8 : 4; }

/// X += Z Z^T with its update vectors, as an eager event does it: rank 6 an element, 12 dofs each.
void low_rank(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
              Index n, Index rank) {
  auto& inverse =
      rows.gpu.kept<Inverse>("inverse/" + precision(fp64) + "/" + std::to_string(n),
                             [&] { return std::make_shared<Inverse>(rows.gpu, fp64, n); });
  std::vector<Index> dofs(static_cast<std::size_t>(2 * rank));
  for (std::size_t t = 0; t < dofs.size(); ++t) {
    dofs[t] = static_cast<Index>(t) * (n / static_cast<Index>(dofs.size()));
  }
  const Eigen::MatrixXd v = 1e-3 * values(2 * rank, 0, rank);
  Work work;
  work.warm_up = true;
  work.run = [&] { inverse.matrix.update(dofs, v); };
  work.milliseconds = device_clock(rows.gpu.device(), "low-rank update");
  work.bytes = inverse.entries() * real_bytes(fp64);  // half of them, read and written
  Eigen::MatrixXd x;
  if (n <= kReferenceLimit) {
    x = values(n, 0, n);
    work.reference = [&] {
      const Eigen::MatrixXd z = x(Eigen::all, dofs) * v;
      x.noalias() += z * z.transpose();
    };
  }
  rows.table.measure(state, name, work);
}

/// Whether products read an inverse as it was uploaded or as an eager update leaves it.
enum class Read { whole, lower };

std::string as_read(Read read) { return read == Read::whole ? "" : "_after_update"; }

/// A product's buffers: the inverse, the board's fields that receive it, partial sums.
struct Product {
  Product(const Gpu& g, bool fp64, const Problem& problem, Read read)
      : fields(g.kernels(fp64), problem, {}),
        inverse(g, fp64, problem.dof_count()),
        partials(g.kernels(fp64), fields.rows(),
                 inverse.matrix.chunks() + inverse.matrix.loaded_chunks({}) + 1),
        commands(g.device()) {
    const Index first = 0;
    if (read == Read::lower) inverse.matrix.update({&first, 1}, Eigen::MatrixXd::Zero(1, 1));
    inverse.matrix.bind(partials, fields.residual());
    sum = partials.bind_sum(fields.positions(), fields.nodal(gpu::Field::displacement));
    std::vector<double> r(fields.rows(), 0.0);
    std::fill_n(r.begin(), problem.dof_count(), 0.25);
    fields.write_residual(r);
  }
  template <class Record>
  void record(const Record& first) {
    commands.begin();
    commands.pass("product");
    const std::uint32_t chunks = first();
    partials.record_sum(commands, *sum, chunks, false);
    commands.end();
  }
  Fields fields;
  Inverse inverse;
  gpu::PartialSums partials;
  std::unique_ptr<vulkan::Binding> sum;
  vulkan::Commands commands;
};

Product& kept_product(const Rows& rows, bool fp64, const Problem& problem, Read read) {
  return rows.gpu.kept<Product>(
      "product/" + precision(fp64) + "/" + std::to_string(problem.dof_count()) + as_read(read),
      [&] { return std::make_shared<Product>(rows.gpu, fp64, problem, read); });
}

void dense_product(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
                   Index cells, Read read) {
  const auto problem = plain_board(cells);
  Product& product = kept_product(rows, fp64, *problem, read);
  product.record([&] { return product.inverse.matrix.record_dense(product.commands, 0); });
  Work work;
  work.warm_up = true;
  work.run = [&] { product.commands.submit(); };
  work.milliseconds = device_clock(rows.gpu.device(), "product");
  work.bytes = product.inverse.entries() * real_bytes(fp64) / (read == Read::lower ? 2 : 1);
  Eigen::MatrixXd x;
  Eigen::VectorXd r, u;
  const Index n = problem->dof_count();
  if (n <= kReferenceLimit) {
    x = values(n, 0, n);
    r = Eigen::VectorXd::Constant(n, 0.25);
    work.reference = [&] { u.noalias() = x * r; };
  }
  rows.table.measure(state, name, work);
}

void few_columns(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
                 Index cells, Read read) {
  constexpr Index kColumns = 12;
  const auto problem = plain_board(cells);
  Product& product = kept_product(rows, fp64, *problem, read);
  const Index n = problem->dof_count();
  gpu::Loaded load;
  for (Index c = 0; c < kColumns; ++c) {
    load.dofs.push_back(c * (n / kColumns));
    load.values.push_back(0.5);
  }
  product.inverse.matrix.set_loaded(load);
  product.record([&] { return product.inverse.matrix.record_loaded(product.commands, 0); });
  Work work;
  work.warm_up = true;
  work.run = [&] { product.commands.submit(); };
  work.milliseconds = device_clock(rows.gpu.device(), "product");
  work.bytes = kColumns * static_cast<double>(n) * real_bytes(fp64);
  Eigen::MatrixXd x;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
  if (n <= kReferenceLimit) {
    x = values(n, 0, n);
    work.reference = [&] {
      u.setZero();
      for (std::size_t c = 0; c < load.dofs.size(); ++c) u += load.values[c] * x.col(load.dofs[c]);
    };
  }
  rows.table.measure(state, name, work);
}

/// Stress of every element with its ratios and the summary; `balance`: f - K u in fp64 as well.
void element_fields(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
                    Index cells, bool balance) {
  const auto problem = plain_board(cells);
  const auto tets = static_cast<double>(problem->tet_count());
  Fields fields(rows.gpu.kernels(fp64), *problem, field_needs());
  std::vector<double> u(3 * problem->mesh().nodes.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 1e-3 * static_cast<double>(i % 101);
  fields.write_displacement(u);
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  vulkan::Commands commands(rows.gpu.device());
  commands.begin();
  if (balance) {
    fields.record_state(commands);
  } else {
    fields.record_correction(commands);
  }
  commands.end();
  Work work;
  work.run = [&] { commands.submit(); };
  // Of an element: four nodes and 12 numbers of its shape in, stress (and corner forces) out.
  const double nodal = 32 * static_cast<double>(problem->node_count());
  work.bytes = tets * (16 + 96 + 12) + nodal;
  if (balance) work.bytes += tets * (8 * real_bytes(fp64) + 112 + 2 * 128) + 3 * nodal;
  std::vector<Voigt> stress(problem->mesh().tets.size());
  std::vector<double> k_u(u.size());
  const std::vector<double> scale(stress.size(), 1.0);
  const std::vector<std::uint8_t> none(stress.size(), 0);
  work.reference = [&] {
    cpu_reference::element_stress(*problem, scale, u, stress);
    benchmark::DoNotOptimize(fem::summarize(*problem, none, none, stress));
    if (balance) fem::apply_stiffness(*problem, scale, u, k_u);
  };
  rows.table.measure(state, name, work);
}

}  // namespace

std::function<double()> device_clock(vulkan::Device& device, const char* pass) {
  if (!device.timing()) return {};
  return [&device, pass] {
    double ms = 0;
    for (const vulkan::PassTime& t : device.take_times()) ms += t.is(pass) ? t.milliseconds : 0;
    return ms;
  };
}

Needs field_needs() {
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  return needs;
}

std::shared_ptr<const Problem> plain_board(Index cells) {
  static std::map<Index, std::shared_ptr<const Problem>> boards;
  auto& board = boards[cells];
  if (!board) {
    Scene scene;
    scene.mesh = test::structured_board({cells, cells, 1, 50, 50, 2.5});
    scene.materials["board"] = {5, 0.4, 2.0};
    scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
    board = std::make_shared<const Problem>(std::move(scene));
  }
  return board;
}

void register_kernel_rows(const Rows& rows) {
  const auto update = [&](bool fp64, Index n, Index rank) {
    const std::string name = "low_rank_update/" + precision(fp64) + "/n" + std::to_string(n) +
                             "/rank" + std::to_string(rank);
    add_row(name, [=, &rows](auto& s) { low_rank(s, rows, name, fp64, n, rank); });
  };
  for (const Index rank : {6, 24, 60}) update(false, 2100, rank);
  update(false, 6000, 6);
  for (const Index rank : {6, 60}) update(true, 2100, rank);  // 60: what the inversion is made of
  update(true, 6000, 6);
  if (rows.big) {
    // Sizes that a device cannot hold are skipped with its error.
    for (const Index n : {2000, 20000, 50000}) {
      update(false, n, 6);
      update(true, n, 6);
    }
  }
  for (const bool fp64 : {false, true}) {
    // 18 cells: 2,052 unknowns; 31: 5,952; 100: 60,600.
    for (const Index cells : rows.big ? std::vector<Index>{18, 31, 57} : std::vector<Index>{18}) {
      const std::string n = "/n" + std::to_string(6 * cells * (cells + 1));
      for (const Read read : {Read::whole, Read::lower}) {
        const std::string dense = "dense_product" + as_read(read) + "/" + precision(fp64) + n;
        add_row(dense, [=, &rows](auto& s) { dense_product(s, rows, dense, fp64, cells, read); });
        const std::string few = "few_columns" + as_read(read) + "/" + precision(fp64) + n;
        add_row(few, [=, &rows](auto& s) { few_columns(s, rows, few, fp64, cells, read); });
      }
    }
  }
  // 18 cells: 1,944 tetrahedra; 129: 99,846; 409: 1,003,686.
  for (const Index cells :
       rows.big ? std::vector<Index>{18, 129, 409} : std::vector<Index>{18, 129}) {
    const std::string tets = "/tets" + std::to_string(6 * cells * cells);
    for (const bool fp64 : {false, true}) {
      for (const bool balance : {false, true}) {
        const std::string name =
            (balance ? "stress_and_residual/" : "stress/") + precision(fp64) + tets;
        add_row(name, [=, &rows](auto& s) { element_fields(s, rows, name, fp64, cells, balance); });
      }
    }
  }
}

}  // namespace sunder::bench
