// SPDX-License-Identifier: Apache-2.0
// Runs CalculiX (an independent finite element program) on a problem of ours: C3D4, the linear
// tetrahedron with one integration point.
#pragma once

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::test {

struct CalculixResult {
  std::vector<double> displacement;  ///< 3 * nodes
  std::vector<Voigt> stress;         ///< in our order
};

namespace calculix {

/// Decks take at most 20 characters a number.
inline std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.13g", v);
  return text;
}

inline void write_mesh(std::ostream& deck, const Problem& problem, std::span<const double> scale) {
  const Mesh& mesh = problem.mesh();
  deck << "*NODE, NSET=NALL\n";
  for (Index n = 0; n < problem.node_count(); ++n) {
    const Vec3& x = mesh.nodes[n];
    deck << n + 1 << ", " << number(x[0]) << ", " << number(x[1]) << ", " << number(x[2]) << "\n";
  }
  // E a_e, nu; with fibres the same along, shear along, and their direction.
  std::map<std::vector<double>, std::vector<Index>> by_material;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    std::vector<double> of{m.young * scale[e], m.poisson};
    if (!m.fibres.empty()) {
      const Vec3 a = problem.fibre_direction(e, 0);
      const Fibres& f = m.fibres.front();
      of.insert(of.end(), {*f.young_along * scale[e], *f.poisson_along, *f.shear_along * scale[e],
                           a.x(), a.y(), a.z()});
    }
    by_material[of].push_back(e);
  }
  int set = 0;
  for (const auto& [elastic, elements] : by_material) {
    const std::string name = std::to_string(set++);
    deck << "*ELEMENT, TYPE=C3D4, ELSET=E" << name << "\n";
    for (Index e : elements) {
      deck << e + 1;
      for (Index n : mesh.tets[e]) deck << ", " << n + 1;
      deck << "\n";
    }
    const auto list = [&](const std::vector<double>& values) {
      for (std::size_t i = 0; i < values.size(); ++i)
        deck << (i > 0 ? ", " : "") << number(values[i]);
      deck << "\n";
    };
    const double young = elastic[0], nu = elastic[1];
    deck << "*MATERIAL, NAME=M" << name << "\n";
    if (elastic.size() == 2) {
      deck << "*ELASTIC\n";
      list({young, nu});
    } else {  // E1, E2, E3, nu12, nu13, nu23, G12, G13, G23: axis 1 along fibres
      deck << "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n";
      const double along = elastic[2], nu_along = elastic[3], shear = elastic[4];
      list({along, young, young, nu_along, nu_along, nu, shear, shear});
      list({young / (2 * (1 + nu)), 293});
      const Vec3 a(elastic[5], elastic[6], elastic[7]), b = a.unitOrthogonal();
      deck << "*ORIENTATION, NAME=O" << name << ", SYSTEM=RECTANGULAR\n";
      list({a.x(), a.y(), a.z(), b.x(), b.y(), b.z()});
    }
    deck << "*SOLID SECTION, ELSET=E" << name << ", MATERIAL=M" << name;
    if (elastic.size() > 2) deck << ", ORIENTATION=O" << name;
    deck << "\n";
  }
  deck << "*ELSET, ELSET=EALL, GENERATE\n1, " << problem.tet_count() << "\n";
}

/// Finite deformation: with NLGEOM *ELASTIC is Saint Venant-Kirchhoff elasticity. Its own bound on
/// the residual is half a percent.
enum class Theory { linear, finite };
inline const char* step_of(Theory theory) {
  return theory == Theory::linear
             ? "*STEP\n*STATIC\n"
             : "*STEP, NLGEOM, INC=1000\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9\n*STATIC\n.1, 1\n";
}

inline void write_step(std::ostream& deck, const Problem& problem, std::span<const double> force,
                       Theory theory) {
  deck << "*BOUNDARY\n";
  for (std::size_t i = 0; i < problem.dofs().size(); ++i) {
    if (problem.dofs()[i] == kNone) deck << i / 3 + 1 << ", " << i % 3 + 1 << "\n";
  }
  deck << step_of(theory) << "*CLOAD\n";
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] != 0) deck << i / 3 + 1 << ", " << i % 3 + 1 << ", " << number(force[i]) << "\n";
  }
  const char* last = theory == Theory::linear ? "" : ", FREQUENCY=1000";  // increment alone
  deck << "*NODE PRINT, NSET=NALL" << last << "\nU\n*EL PRINT, ELSET=EALL, GLOBAL=YES" << last
       << "\nS\n*END STEP\n";
}

inline CalculixResult read_dat(const std::string& file, const Problem& problem) {
  std::ifstream in(file);
  CalculixResult result;
  result.displacement.assign(problem.dofs().size(), 0.0);
  result.stress.assign(problem.mesh().tets.size(), Voigt::Zero());
  bool stresses = false;
  std::size_t nodes = 0, elements = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.find("displacements") != std::string::npos) stresses = false;
    if (line.find("stresses") != std::string::npos) stresses = true;
    std::istringstream fields(line);
    std::size_t id = 0;
    if (!(fields >> id)) continue;
    if (!stresses) {
      for (std::size_t axis = 0; axis < 3; ++axis) fields >> result.displacement[3 * id - 3 + axis];
      nodes += fields ? 1 : 0;
    } else {
      int point = 0;
      double xx, yy, zz, xy, xz, yz;
      fields >> point >> xx >> yy >> zz >> xy >> xz >> yz;
      result.stress[id - 1] << xx, yy, zz, xy, yz, xz;
      elements += fields ? 1 : 0;
    }
  }
  if (nodes != problem.mesh().nodes.size() || elements != problem.mesh().tets.size()) {
    throw std::runtime_error(file + " does not hold all nodes and elements");
  }
  return result;
}

}  // namespace calculix

/// Is there a program ccx? (Debian: apt-get install calculix-ccx.)
inline bool calculix_installed() { return std::system("command -v ccx > /dev/null 2>&1") == 0; }

/// `folder` is emptied first and removed afterwards.
inline CalculixResult run_calculix(const Problem& problem, std::span<const double> scale,
                                   std::span<const double> force,
                                   const std::filesystem::path& folder,
                                   calculix::Theory theory = calculix::Theory::linear) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  {
    std::ofstream deck(folder / "deck.inp");
    calculix::write_mesh(deck, problem, scale);
    calculix::write_step(deck, problem, force, theory);
  }
  const std::string command = "cd '" + folder.string() + "' && ccx deck > log 2>&1";
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("ccx failed; see " + (folder / "log").string());
  }
  CalculixResult result = calculix::read_dat((folder / "deck.dat").string(), problem);
  std::filesystem::remove_all(folder);
  return result;
}

}  // namespace sunder::test
