// SPDX-License-Identifier: Apache-2.0
// The surface that a host draws against faces counted one by one; a mesh carried by the body.
#include "sunder/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "sunder/skin.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

using Corners = std::array<Index, 3>;

/// From its lowest node on, the same way round.
Corners turned(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// Faces of live elements that no other one shares, as the body's corners are now; outward, by the
/// sign of the volume that they span with the element's fourth corner.
std::set<Corners> brute(const Simulation& s) {
  const Mesh mesh = s.mesh();
  std::map<Corners, std::vector<Corners>> faces;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (s.backend().destroyed()[e]) continue;
    const auto& tet = mesh.tets[e];
    for (std::size_t f = 0; f < 4; ++f) {
      Corners face{tet[(f + 1) % 4], tet[(f + 2) % 4], tet[(f + 3) % 4]};
      const auto x = [&](Index n) { return mesh.nodes[static_cast<std::size_t>(n)]; };
      const Vec3 to = x(tet[f]) - x(face[0]);
      if ((x(face[1]) - x(face[0])).cross(x(face[2]) - x(face[0])).dot(to) > 0) {
        std::swap(face[1], face[2]);
      }
      Corners key = face;
      std::ranges::sort(key);
      faces[key].push_back(face);
    }
  }
  std::set<Corners> ends;
  for (const auto& [key, sides] : faces) {
    if (sides.size() == 1) ends.insert(turned(sides[0]));
  }
  return ends;
}

std::set<Corners> shown(const Surface& surface) {
  std::set<Corners> triangles;
  for (const SurfaceTriangle& t : surface.triangles()) triangles.insert(turned(t.nodes));
  EXPECT_EQ(triangles.size(), surface.triangles().size()) << "none twice";
  return triangles;
}

/// A host's copy, which takes changes alone.
struct Drawn {
  std::vector<SurfaceTriangle> triangles;
  std::uint64_t version = 0;
  std::size_t taken = 0;

  void follow(const Surface& surface) {
    const auto places = surface.changed_since(version);
    taken = places.size();
    triangles.resize(surface.triangles().size());
    for (std::uint32_t p : places) {
      if (p < triangles.size()) triangles[p] = surface.triangles()[p];
    }
    version = surface.version();
  }
};

void expect_right(const Simulation& simulation, const Surface& surface, const Drawn& drawn) {
  EXPECT_TRUE(shown(surface) == brute(simulation));
  ASSERT_EQ(drawn.triangles.size(), surface.triangles().size());
  for (std::size_t t = 0; t < drawn.triangles.size(); ++t) {
    const SurfaceTriangle &a = drawn.triangles[t], &b = surface.triangles()[t];
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.element, b.element);
    EXPECT_EQ(a.piece, b.piece);
    EXPECT_EQ(b.piece, simulation.piece_of(b.element));
  }
}

Scene live_block() {
  Scene scene = strip(1e9, 1, 100);
  scene.mesh = structured_board({6, 8, 3, 6, 8, 3});
  scene.instruments[0].ramp.reset();
  scene.live = true;
  return scene;
}

struct BlockRun : SceneRun {
  BlockRun() : SceneRun(live_block()) {
    simulation.keep_history([p = problem] { return cpu_reference::create(p, needs_of(*p)); });
  }
};

TEST(Surface, FollowsRandomRemovalsAndTheirReturn) {
  BlockRun run;
  Simulation& s = run.simulation;
  Surface surface(s);
  Drawn drawn;
  drawn.follow(surface);
  EXPECT_EQ(surface.version(), 1U);
  EXPECT_EQ(drawn.triangles.size(), 2 * 2 * (6 * 8 + 6 * 3 + 8 * 3U)) << "two a square outside";
  expect_right(s, surface, drawn);
  EXPECT_EQ(surface.update(), 1U) << "nothing has changed";
  std::mt19937 random(7);
  for (int i = 0; i < 60; ++i) {
    if (s.undos() > 3 && random() % 4 == 0) {
      s.undo(static_cast<int>(1 + random() % 3));
    } else {
      std::vector<Index> live;
      for (Index e = 0; e < run.problem->tet_count(); ++e) {
        if (!s.backend().destroyed()[e]) live.push_back(e);
      }
      std::ranges::shuffle(live, random);
      live.resize(1 + random() % 6);
      s.remove(live);
    }
    surface.update();
    drawn.follow(surface);
    expect_right(s, surface, drawn);
  }
}

TEST(Surface, CostsWhatHasChanged) {
  BlockRun run;
  Surface surface(run.simulation);
  Drawn drawn;
  drawn.follow(surface);
  run.simulation.remove(std::vector<Index>{100});
  surface.update();
  drawn.follow(surface);
  EXPECT_LE(drawn.taken, 8U) << "four faces at most, and what takes the places of those that went";
  EXPECT_GE(drawn.taken, 1U);
}

TEST(Surface, SaysWhatIsALipAndWhatHasComeLoose) {
  Scene scene = strip(1e9, 2, 4);
  scene.live = true;
  SceneRun run(std::move(scene));
  run.simulation.step();
  Surface surface(run.simulation);
  const auto opened = [&] {
    return std::ranges::count_if(surface.triangles(), [](const auto& t) { return t.opened; });
  };
  EXPECT_EQ(opened(), 0);
  std::vector<Index> across;
  for (Index e = 6 * 4 * 5; e < 6 * 4 * 6; ++e) across.push_back(e);
  run.simulation.remove(across);
  surface.update();
  EXPECT_EQ(opened(), 2 * 4 * 2) << "both lips, two triangles a cell";
  std::set<Index> pieces;
  for (const SurfaceTriangle& t : surface.triangles()) pieces.insert(t.piece);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_TRUE(pieces.contains(kNone)) << "what the support holds";
  EXPECT_TRUE(pieces.contains(0)) << "the pulled end, by its first element";
}

TEST(Surface, FollowsSplitCracks) {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  scene.fracture.max_events = 2;
  scene.instruments[0].ramp.reset();
  SceneRun run(std::move(scene));
  Surface surface(run.simulation);
  Drawn drawn;
  for (int i = 0; i < 5; ++i) {
    run.simulation.step();
    surface.update();
    drawn.follow(surface);
    expect_right(run.simulation, surface, drawn);
  }
  EXPECT_GT(surface.node_count(), run.problem->mesh().nodes.size());
  // What split cracks say of their faces are two lips each.
  const std::set<Corners> triangles = shown(surface);
  const auto faces = run.simulation.crack_faces();
  ASSERT_FALSE(faces.empty());
  for (const CrackFace& face : faces) {
    std::set<Index> left(face.left.begin(), face.left.end());
    const bool lip = std::ranges::any_of(
        triangles, [&](const Corners& t) { return left == std::set<Index>(t.begin(), t.end()); });
    EXPECT_TRUE(lip);
  }
}

TEST(Surface, PointsAndNormalsAreThoseOfTheBodyAsItIs) {
  Scene scene = strip(1e9, 2, 1);
  SceneRun run(std::move(scene));
  run.simulation.step();
  Surface surface(run.simulation);
  const std::size_t nodes = surface.node_count();
  std::vector<float> places(3 * nodes), normals(3 * nodes);
  surface.points(places, normals);
  const auto u = run.simulation.displacement();
  for (std::size_t n = 0; n < nodes; ++n) {
    const Vec3 at = run.problem->mesh().nodes[n] + u[n];
    Vec3 normal;
    for (int i = 0; i < 3; ++i) {
      const std::size_t v = 3 * n + static_cast<std::size_t>(i);
      EXPECT_EQ(places[v], static_cast<float>(at[i]));
      normal[i] = normals[v];
    }
    EXPECT_NEAR(normal.norm(), 1, 1e-6) << "one cell thick: every node is outside";
    const Vec3 inward = Vec3(2, 4, 0.5) - run.problem->mesh().nodes[n];
    EXPECT_LT(normal.dot(inward), 0) << n;
  }
  // In the middle of the upper face the body ends upwards.
  const Index middle = grid_node({4, 8, 1}, 2, 4, 1);
  EXPECT_GT(normals[3 * static_cast<std::size_t>(middle) + 2], 0.9F);
  EXPECT_THROW(surface.points(std::span(places).first(6), {}), UsageError);
  surface.points({}, normals);
}

TEST(Skin, IsCarriedByTheElementThatHoldsIt) {
  SceneRun run(strip(1e9, 2, 1));
  const Mesh& mesh = run.problem->mesh();
  std::vector<Vec3> vertices;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> of(0, 1);
  for (int i = 0; i < 500; ++i) vertices.emplace_back(4 * of(random), 8 * of(random), of(random));
  vertices.push_back(mesh.nodes[17]);
  vertices.emplace_back(2.2, 3.1, 1.4);  // above the body
  const Skin skin(run.simulation, vertices);
  std::vector<float> places(3 * vertices.size());
  std::vector<std::uint8_t> lives(vertices.size(), 7);
  skin.places(places, lives);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(places[3 * v + static_cast<std::size_t>(i)], vertices[v][i], 1e-5) << "at rest";
    }
    EXPECT_EQ(lives[v], 1);
  }
  run.simulation.step();
  skin.places(places, lives);
  const auto u = run.simulation.displacement();
  for (std::size_t v = 0; v < 500; ++v) {
    // Inside an element displacement is linear: by its gradient from any corner.
    const Index e = skin.element(v);
    const auto& tet = mesh.tets[static_cast<std::size_t>(e)];
    const TetShape& shape = run.problem->shape(e);
    Mat3 gradient = Mat3::Zero();
    for (int a = 0; a < 4; ++a) {
      gradient += u[static_cast<std::size_t>(tet[static_cast<std::size_t>(a)])] *
                  shape.gradient.col(a).transpose();
    }
    const Vec3 from = vertices[v] - mesh.nodes[static_cast<std::size_t>(tet[0])];
    for (int a = 0; a < 4; ++a) {
      const double share = (a == 0 ? 1 : 0) + shape.gradient.col(a).dot(from);
      EXPECT_GE(share, -1e-9) << "not inside";
    }
    const Vec3 at = vertices[v] + u[static_cast<std::size_t>(tet[0])] + gradient * from;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(places[3 * v + static_cast<std::size_t>(i)], at[i], 1e-5);
    }
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(places[1500 + static_cast<std::size_t>(i)], (mesh.nodes[17] + u[17])[i], 1e-5);
  }
}

TEST(Skin, SaysWhatDiesWithItsElement) {
  Scene scene = strip(1e9, 2, 1);
  scene.live = true;
  SceneRun run(std::move(scene));
  const std::vector<Vec3> vertices{Vec3(0.5, 0.5, 0.5), Vec3(3.5, 7.5, 0.5)};
  const Skin skin(run.simulation, vertices);
  run.simulation.remove(std::vector<Index>{skin.element(0)});
  std::vector<float> places(6);
  std::vector<std::uint8_t> lives(2);
  skin.places(places, lives);
  EXPECT_EQ(lives, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_THROW(Skin(run.simulation, std::vector<Vec3>{Vec3(0, NAN, 0)}), UsageError);
  EXPECT_THROW(skin.places(std::span(places).first(3), {}), UsageError);
}

}  // namespace
}  // namespace sunder::test
