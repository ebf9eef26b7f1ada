// SPDX-License-Identifier: Apache-2.0
// Mesh size against discretisation error against time: a cantilever, Cook's membrane in plane
// stress, and the board of Table 1 pulled along its lower edge; one CSV row per mesh. Time is that
// of everything from the mesh on: checks, assembly, factor, solution, by the route that the library
// chooses. Errors are those of one displacement: against Timoshenko's beam, the published value,
// and the board's own limit (Richardson from the three finest meshes of the run).
//   bench_convergence FILE [TETS]       meshes up to TETS tetrahedra (160000)
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <iostream>

#include "bench/tearing_board.hpp"
#include "support/body.hpp"
#include "support/traction.hpp"
#include "verification/engine_cases.hpp"

namespace sunder::bench {
namespace {

struct MeshSize {
  Index tets = 0;
  double value = 0, milliseconds = 0;
};

MeshSize timed(Index tets, const std::function<double()>& run) {
  const auto start = std::chrono::steady_clock::now();
  const double value = run();
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  return {tets, value, time.count()};
}

/// Mean displacement down of the lower edge under a uniform pull along it.
double board_deflection(Index cells) {
  const TearingBoard board(cells);
  const test::Body body(board.problem->scene(), Needs{});
  const Mesh& mesh = body.problem->mesh();
  const auto low = [](const Vec3& x) { return x.y() < 1e-9; };
  body.load(test::traction_force(mesh, low, [](const Vec3&) { return Vec3(0.1, -0.5, 0); }));
  body.backend->solve();
  const auto u = body.displacement();
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!low(mesh.nodes[n])) continue;
    sum += u[3 * n + 1];
    ++count;
  }
  return sum / count;
}

/// Limit of a sequence whose cells halve from one to the next (Richardson): order from the three
/// finest, 1 when there are only two.
double limit_of(const std::vector<MeshSize>& sizes) {
  const auto step = [&](std::size_t back) {
    return sizes[sizes.size() - back].value - sizes[sizes.size() - back - 1].value;
  };
  const double ratio = sizes.size() > 2 ? step(2) / step(1) : 2;
  return sizes.back().value + step(1) / (ratio - 1);
}

void write(std::ostream& out, const std::string& name, const std::vector<MeshSize>& sizes,
           double exact) {
  for (const MeshSize& m : sizes) {
    out << name << ',' << m.tets << ',' << m.value << ',' << std::abs(m.value / exact - 1) << ','
        << m.milliseconds << '\n';
  }
}

std::vector<MeshSize> sweep(std::initializer_list<Index> cells, Index most,
                            const std::function<Index(Index)>& tets,
                            const std::function<double(Index)>& run) {
  std::vector<MeshSize> sizes;
  for (Index n : cells) {
    if (tets(n) <= most) sizes.push_back(timed(tets(n), [&] { return run(n); }));
  }
  return sizes;
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  using namespace sunder;
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: bench_convergence FILE [TETS]\n";
    return 2;
  }
  const Index most = argc > 2 ? std::atoi(argv[2]) : 160000;
  if (most < 3000) {
    std::cerr << "bench_convergence: TETS must be 3000 or more\n";
    return 2;
  }
  const auto layer = [](Index n) { return 6 * n * n; };
  std::ofstream out(argv[1]);
  out.precision(10);
  out << "case,tets,value,error,ms\n";
  bench::write(out, "cantilever",
               bench::sweep(
                   {2, 4, 6, 8, 10, 12}, most, [](Index n) { return 60 * n * n * n; },
                   [](Index n) { return test::mean_end_deflection(n, 1); }),
               test::kTimoshenko);
  bench::write(out, "Cook's membrane",
               bench::sweep({8, 16, 32, 64, 96, 136}, most, layer,
                            [](Index n) { return test::cook_deflection(test::Plane::stress, n); }),
               test::cook_published(test::Plane::stress));
  const auto board = bench::sweep({10, 20, 40, 80, 160}, most, layer, bench::board_deflection);
  bench::write(out, "board", board, bench::limit_of(board));
  out.close();
  if (!out) std::cerr << "cannot write " << argv[1] << '\n';
  return out ? 0 : 3;
}
