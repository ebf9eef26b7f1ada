// SPDX-License-Identifier: Apache-2.0
// What whole systems of equations take, on a GPU by its own clock: the product K p, conjugate
// gradients, the dense inverse computed on the device.
#include <algorithm>
#include <chrono>
#include <optional>

#include "body/assembly.hpp"
#include "cpu_reference/conjugate_gradient.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/host_inverse.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "gpu/passes/inverse_refinement.hpp"
#include "vulkan_rows.hpp"

namespace sunder::bench {
namespace {

using gpu::DenseInverse;
using gpu::Fields;

/// Conjugate gradients on an assembled matrix with one number a diagonal entry (point-Jacobi): the
/// device's inverts 3 x 3 blocks (block-Jacobi), which costs nine products a node more and takes
/// fewer iterations. Times are those of one iteration.
class AssembledCg {
 public:
  explicit AssembledCg(const Problem& problem) : k_(fem::assemble_lower(problem, {})) {
    const Eigen::VectorXd d = k_.diagonal();
    inverse_ = d.cwiseInverse();
  }
  int solve(const Eigen::VectorXd& f, double reduction) const {
    Eigen::VectorXd x;
    const auto a = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
      out.noalias() = k_.selfadjointView<Eigen::Lower>() * in;
    };
    const auto m = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
      out = inverse_.cwiseProduct(in);
    };
    return cpu_reference::conjugate_gradient(a, m, f, {.relative = reduction}, x).iterations;
  }

 private:
  linear_algebra::SparseMatrix k_;
  Eigen::VectorXd inverse_;
};

/// Time per iteration, of a solution to ten digits by a route that knows that of another load
/// alone: one that it knows takes no iteration, and the first one makes what all others go by.
void conjugate_gradients(benchmark::State& state, const Rows& rows, const std::string& name,
                         Index cells) {
  rows.gpu.release();
  const auto problem = plain_board(cells);
  Fields fields(rows.gpu.kernels(true), *problem, field_needs(), {0, true});
  const fem::DamagedBody body(problem);
  std::optional<gpu::CgRoute> route;
  struct Pull {
    Load load;
    std::vector<double> force;
  };
  const auto pull = [&](Index axis) {
    Pull of{{}, std::vector<double>(fields.rows(), 0.0)};
    for (Index d = axis; d < problem->dof_count(); d += 3) {
      of.load.force_dofs.push_back(d);
      of.load.forces.push_back(d % 2 == 0 ? 1e-3 : -1e-3);
      of.force[static_cast<std::size_t>(d)] = of.load.forces.back();
    }
    return of;
  };
  const Pull other = pull(0), pulled = pull(1);
  const auto solve = [&](const Pull& of) {
    fields.set_load(of.force, {});
    return route->solve(of.load, 0, true);
  };
  const std::vector<double> rest(3 * problem->mesh().nodes.size(), 0.0);
  int iterations = 1;
  double wall = 0;
  Work work;
  work.warm_up = true;
  work.prepare = [&] {
    fields.write_displacement(rest);
    route.emplace(rows.gpu.kernels(true), body, fields);
    solve(other);
  };
  work.run = [&] {
    const auto start = std::chrono::steady_clock::now();
    iterations = solve(pulled);
    wall =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  work.milliseconds = [&] { return wall / std::max(iterations, 1); };
  // The matrix once, 13 passes over vectors of four values a node, two over places in groups.
  work.bytes = static_cast<double>(fields.matrix().bytes()) +
               (13 * 32 + 2 * 16) * static_cast<double>(problem->node_count());
  Row& row = rows.table.measure(state, name, work);
  state.counters["iterations"] = iterations;
  if (iterations < 10) state.SkipWithError("a solution that was known is no measure");
  const AssembledCg reference(*problem);
  const Eigen::Map<const Eigen::VectorXd> f(pulled.force.data(), problem->dof_count());
  const auto start = std::chrono::steady_clock::now();
  const int steps = std::max(1, reference.solve(f, 1e-4));
  row.reference_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() /
      steps;
  state.counters["reference_ms"] = row.reference_ms;
}

/// q = K p with its sum p^T q, from 3 x 3 blocks in fp64.
void stiffness_product(benchmark::State& state, const Rows& rows, const std::string& name,
                       Index cells) {
  rows.gpu.release();
  const auto problem = plain_board(cells);
  const gpu::KernelFactory& kernels = rows.gpu.kernels(true);
  vulkan::Device& device = rows.gpu.device();
  const Fields fields(kernels, *problem, field_needs(), {0, true});
  const gpu::BlockMatrix& matrix = fields.matrix();
  const std::size_t bytes = std::size_t{matrix.groups()} * shaders::kGroup * 4 * sizeof(double);
  const vulkan::Buffer p(device, bytes, vulkan::Placement::device);
  const vulkan::Buffer q(device, bytes, vulkan::Placement::device);
  const vulkan::Buffer sums(device, matrix.groups() * kernels.parts() * sizeof(double),
                            vulkan::Placement::device);
  const auto kernel = kernels.make("cg_multiply");
  const vulkan::Buffer* buffers[] = {
      &matrix.blocks(), &matrix.slices(), &fields.dofs(), &p, &q, &sums};
  const vulkan::Binding binding(device, *kernel, buffers);
  vulkan::Commands commands(device);
  commands.begin();
  commands.fill_zero(p, 0, bytes);
  commands.end();
  commands.submit();
  commands.begin();
  commands.pass("product");
  commands.dispatch(binding, matrix.groups());
  commands.end();
  Work work;
  work.warm_up = true;
  work.run = [&] { commands.submit(); };
  work.milliseconds = device_clock(device, "product");
  work.bytes = static_cast<double>(matrix.bytes() + 2 * bytes);
  const linear_algebra::SparseMatrix k = fem::assemble_lower(*problem, {});
  const Eigen::VectorXd in = Eigen::VectorXd::Constant(problem->dof_count(), 0.25);
  Eigen::VectorXd out;
  work.reference = [&] { out.noalias() = k.selfadjointView<Eigen::Lower>() * in; };
  rows.table.measure(state, name, work);
}

/// X from K, in fp64; beside it the host's, from its sparse factor.
void inversion(benchmark::State& state, const Rows& rows, const std::string& name, Index cells) {
  rows.gpu.release();
  const auto problem = plain_board(cells);
  const gpu::KernelFactory& kernels = rows.gpu.kernels(true);
  const linear_algebra::SparseMatrix lower = fem::assemble_lower(*problem, {});
  const Index n = problem->dof_count();
  const auto padded = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  DenseInverse inverse(kernels, n, padded, 0);
  Work work;
  work.warm_up = true;
  work.run = [&] { gpu::invert_on_device(kernels, lower, padded, 0, inverse); };
  work.reference = [&] { benchmark::DoNotOptimize(gpu::HostInverse(*problem, true).bytes()); };
  rows.table.measure(state, name, work);
}

/// X += X (I - K X) of that, which follows where frames are stiff.
void inverse_refinement(benchmark::State& state, const Rows& rows, const std::string& name,
                        Index cells) {
  rows.gpu.release();
  const auto problem = plain_board(cells);
  const gpu::KernelFactory& kernels = rows.gpu.kernels(true);
  const fem::DamagedBody body(problem);
  const Index n = problem->dof_count();
  const auto padded = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  DenseInverse inverse(kernels, n, padded, 0);
  gpu::invert_on_device(kernels, body.stiffness(), padded, 0, inverse);
  Work work;
  work.warm_up = true;
  work.run = [&] { gpu::refine_inverse(kernels, body, padded, inverse); };
  rows.table.measure(state, name, work);
}

}  // namespace

void register_system_rows(const Rows& rows) {
  // 133 cells: 35,912 nodes.
  add_row("stiffness_product/fp64/nodes35912", [&rows](auto& s) {
    stiffness_product(s, rows, "stiffness_product/fp64/nodes35912", 133);
  });
  for (const Index cells : rows.big ? std::vector<Index>{18, 31, 57} : std::vector<Index>{18}) {
    const std::string size = "/fp64/n" + std::to_string(6 * cells * (cells + 1));
    const std::string name = "inversion" + size, refinement = "inverse_refinement" + size;
    add_row(name, [=, &rows](auto& s) { inversion(s, rows, name, cells); });
    add_row(refinement, [=, &rows](auto& s) { inverse_refinement(s, rows, refinement, cells); });
  }
  // 133 cells: as many nodes as the product above.
  for (const Index cells :
       rows.big ? std::vector<Index>{18, 133, 409} : std::vector<Index>{18, 77, 133}) {
    const std::string name = "cg_iteration/fp64/tets" + std::to_string(6 * cells * cells);
    // Seconds are those of one iteration of a whole solution each.
    add_row(
        name, [=, &rows](auto& s) { conjugate_gradients(s, rows, name, cells); }, 1e-3);
  }
}

}  // namespace sunder::bench
