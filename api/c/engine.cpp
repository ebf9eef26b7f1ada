// SPDX-License-Identifier: Apache-2.0
#include "c/engine.hpp"

#include "c/names.hpp"
#include "c/text.hpp"

namespace sunder::c {

sunder_engine describe(const Problem& problem, const BackendInfo& info) {
  auto engine = sized<sunder_engine>();
  engine.backend = backend_number(info.backend);
  engine.nodes = problem.node_count();
  engine.tets = problem.tet_count();
  engine.unknowns = problem.dof_count();
  engine.memory_bytes = info.memory_bytes;
  write_text(info.device, engine.device);
  write_text(info.driver, engine.driver);
  write_text(info.precision, engine.precision);
  write_text(info.route, engine.route);
  write_text(info.update, engine.update);
  write_text(info.why, engine.why);
  return engine;
}

}  // namespace sunder::c
