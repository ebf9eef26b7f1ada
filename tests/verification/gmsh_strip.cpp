// SPDX-License-Identifier: Apache-2.0
#include "verification/gmsh_strip.hpp"

#include <gmsh.h>

#include <map>

namespace sunder::test {
namespace {

namespace geo = gmsh::model::geo;

/// gmsh's session, quiet and the same every time.
class Session {
 public:
  explicit Session(PlaneMesh how) {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("Mesh.RandomSeed", 1);
    gmsh::option::setNumber("Mesh.Algorithm", static_cast<int>(how));
    gmsh::option::setNumber("Mesh.Algorithm3D", 1);
    gmsh::option::setNumber("Mesh.CharacteristicLengthFromPoints", 0);
    gmsh::option::setNumber("Mesh.CharacteristicLengthExtendFromBoundary", 0);
  }
  ~Session() { gmsh::finalize(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

struct Rectangle {
  double width, low, high;  // mm
};

/// `slot` x `height`, in the middle of the left side.
int rectangle_with_slot(const Rectangle& sides, double notch, double height) {
  const auto& [width, low, high] = sides;
  const double middle = (low + high) / 2;
  const int a = geo::addPoint(0, low, 0), b = geo::addPoint(width, low, 0),
            c = geo::addPoint(width, high, 0), d = geo::addPoint(0, high, 0);
  const int bottom = geo::addLine(a, b), right = geo::addLine(b, c), top = geo::addLine(c, d);
  if (!(notch > 0)) {
    const int left = geo::addLine(d, a);
    return geo::addPlaneSurface({geo::addCurveLoop({bottom, right, top, left})});
  }
  const double up = middle + height / 2, down = middle - height / 2;
  const int p = geo::addPoint(0, up, 0), q = geo::addPoint(notch, up, 0),
            r = geo::addPoint(notch, down, 0), s = geo::addPoint(0, down, 0);
  const int upper_left = geo::addLine(d, p), upper = geo::addLine(p, q), end = geo::addLine(q, r),
            lower = geo::addLine(r, s), lower_left = geo::addLine(s, a), mouth = geo::addLine(p, s);
  const int strip = geo::addPlaneSurface(
      {geo::addCurveLoop({bottom, right, top, upper_left, upper, end, lower, lower_left})});
  geo::addPlaneSurface({geo::addCurveLoop({upper, end, lower, -mouth})});
  return strip;
}

/// Size 1 within W/2 of the crack's line, growing by a tenth of the distance beyond.
void set_size(double width) {
  const int field = gmsh::model::mesh::field::add("MathEval");
  const std::string beyond = "(Fabs(y)-" + std::to_string(width / 2) + ")";
  gmsh::model::mesh::field::setString(field, "F", "1+0.05*(" + beyond + "+Fabs(" + beyond + "))");
  gmsh::model::mesh::field::setAsBackgroundMesh(field);
}

Mesh read_mesh() {
  Mesh mesh;
  mesh.volumes.push_back({"board", 1});
  std::vector<std::size_t> tags;
  std::vector<double> xyz, parametric;
  gmsh::model::mesh::getNodes(tags, xyz, parametric);
  std::map<std::size_t, Vec3> at;
  for (std::size_t i = 0; i < tags.size(); ++i)
    at[tags[i]] = Vec3(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
  std::vector<std::size_t> elements, corners;
  gmsh::model::mesh::getElementsByType(4, elements, corners);
  std::map<std::size_t, Index> number;
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    std::array<Index, 4> tet{};
    for (std::size_t a = 0; a < 4; ++a) {
      const auto [place, fresh] = number.try_emplace(corners[i + a], mesh.node_count());
      if (fresh) mesh.nodes.push_back(at.at(corners[i + a]));
      tet[a] = place->second;
    }
    mesh.tets.push_back(tet);
    mesh.volume_of.push_back(0);
  }
  return mesh;
}

Mesh strip_mesh(int n, int notch, PlaneMesh how) {
  const Session session(how);
  rectangle_with_slot({1.0 * n, -3.0 * n, 3.0 * n}, notch, 1);
  geo::synchronize();
  gmsh::vectorpair faces, solids;
  gmsh::model::getEntities(faces, 2);
  geo::extrude(faces, 0, 0, 1, solids);
  geo::synchronize();
  set_size(n);
  gmsh::model::mesh::generate(3);
  return read_mesh();
}

/// A square with a round hole in its middle.
void square_with_hole(double side, double radius) {
  const double m = side / 2;
  const int a = geo::addPoint(0, 0, 0), b = geo::addPoint(side, 0, 0),
            c = geo::addPoint(side, side, 0), d = geo::addPoint(0, side, 0);
  const int outer = geo::addCurveLoop(
      {geo::addLine(a, b), geo::addLine(b, c), geo::addLine(c, d), geo::addLine(d, a)});
  const int middle = geo::addPoint(m, m, 0), p = geo::addPoint(m + radius, m, 0),
            q = geo::addPoint(m, m + radius, 0), r = geo::addPoint(m - radius, m, 0),
            s = geo::addPoint(m, m - radius, 0);
  const int inner =
      geo::addCurveLoop({geo::addCircleArc(p, middle, q), geo::addCircleArc(q, middle, r),
                         geo::addCircleArc(r, middle, s), geo::addCircleArc(s, middle, p)});
  geo::addPlaneSurface({outer, inner});
}

/// Even up to 4 mm beside the hole, growing by a fifth of the distance beyond.
void set_size_round_hole(const GmshBoard& wanted) {
  const int field = gmsh::model::mesh::field::add("MathEval");
  const std::string middle = std::to_string(kGmshBoardSide / 2);
  const std::string beyond =
      "(Sqrt((x-" + middle + ")^2+(y-" + middle + ")^2)-" + std::to_string(wanted.hole + 4) + ")";
  gmsh::model::mesh::field::setString(
      field, "F", std::to_string(wanted.size) + "+0.1*(" + beyond + "+Fabs(" + beyond + "))");
  gmsh::model::mesh::field::setAsBackgroundMesh(field);
}

Index nearest(const Mesh& mesh, const Vec3& p) {
  Index best = 0;
  for (Index n = 1; n < mesh.node_count(); ++n)
    if ((mesh.nodes[n] - p).norm() < (mesh.nodes[best] - p).norm()) best = n;
  return best;
}

CrackedBody make_strip(int n, int notch, PlaneMesh how) {
  Scene scene;
  scene.mesh = strip_mesh(n, notch, how);
  scene.materials["board"] = {5, 0.3, 2.0};
  const Index low = nearest(scene.mesh, Vec3(n, -3 * n, 0)),
              high = nearest(scene.mesh, Vec3(n, 3 * n, 0)),
              left = nearest(scene.mesh, Vec3(0, -3 * n, 0));
  scene.supports.push_back({std::vector<Index>{low}, Axes{7}});
  scene.supports.push_back({std::vector<Index>{high}, Axes{5}});
  scene.supports.push_back({std::vector<Index>{left}, Axes{4}});
  return CrackedBody(std::move(scene));
}

}  // namespace

Mesh gmsh_board(const GmshBoard& wanted) {
  constexpr double kThickness = 2;
  const Session session(PlaneMesh::delaunay);
  if (wanted.hole > 0) {
    square_with_hole(kGmshBoardSide, wanted.hole);
  } else {
    rectangle_with_slot({kGmshBoardSide, 0, kGmshBoardSide}, wanted.notch, wanted.size);
  }
  geo::synchronize();
  gmsh::vectorpair faces, solids;
  gmsh::model::getEntities(faces, 2);
  geo::extrude(faces, 0, 0, kThickness, solids);
  geo::synchronize();
  gmsh::option::setNumber("Mesh.CharacteristicLengthMin", wanted.size);
  gmsh::option::setNumber("Mesh.CharacteristicLengthMax", wanted.hole > 0 ? 3 : wanted.size);
  if (wanted.hole > 0) set_size_round_hole(wanted);
  gmsh::model::mesh::generate(3);
  return read_mesh();
}

CrackedBody gmsh_strip(int n, int notch, PlaneMesh how) {
  CrackedBody body = make_strip(n, notch, how);
  std::vector<Index> slot;
  const Mesh& mesh = body.problem().mesh();
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    Vec3 c = Vec3::Zero();
    for (Index node : mesh.tets[e]) c += mesh.nodes[node] / 4;
    if (c.x() < notch && std::abs(c.y()) < 0.5) slot.push_back(e);
  }
  body.set_crack(CrackKind::edge, {0, 0}, {notch, 0}, slot);
  body.load_uniform(0, 1, 0);
  body.solve();
  return body;
}

CrackedBody grown_strip(int n, double length, PlaneMesh how) {
  CrackedBody body = make_strip(n, 0, how);
  body.set_crack(CrackKind::edge, {0, 0}, {1e-9, 0}, {});
  body.grow(0, {1, 0}, length);
  body.load_uniform(0, 1, 0);
  body.solve();
  return body;
}

}  // namespace sunder::test
