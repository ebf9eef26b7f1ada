// SPDX-License-Identifier: Apache-2.0
// What `sunder plan` says of a scene, against values from the scene's own sizes: 242 nodes, of
// which the 22 of the upper edge are held, 500 tetrahedra.
#include <gtest/gtest.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "app/output/program.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr std::size_t kNodes = 242, kElements = 500, kUnknowns = 3 * (kNodes - 22);

/// The program's plan of the tearing board with some overrides, or of a scene of scenes/.
class Plan {
 public:
  explicit Plan(const std::vector<std::string>& overrides, const char* scene = nullptr) {
    const TempFolder folder;
    const TearingBoard board(folder);
    const std::string path =
        scene ? std::string(SUNDER_SOURCE "/scenes/") + scene : board.scene.string();
    std::vector<std::string> arguments = {"plan", path, "--backend", "cpu"};
    for (const std::string& o : overrides) arguments.insert(arguments.end(), {"--set", o});
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    text_ = outcome.out;
  }

  [[nodiscard]] const std::string& text() const { return text_; }

  /// Lines under a title, without their indent.
  [[nodiscard]] std::vector<std::string> under(const std::string& title) const {
    std::vector<std::string> lines;
    std::size_t at = text_.find("\n" + title + "\n");
    if (at == std::string::npos) {
      ADD_FAILURE() << "no " << title << " in\n" << text_;
      return lines;
    }
    for (at += title.size() + 2; text_.compare(at, 2, "  ") == 0;) {
      const std::size_t end = text_.find('\n', at);
      lines.push_back(text_.substr(at + 2, end - at - 2));
      at = end + 1;
    }
    return lines;
  }

  /// What is said of a name under a title; empty: it is not there.
  [[nodiscard]] std::string of(const std::string& title, const std::string& name) const {
    for (const std::string& line : under(title)) {
      if (!line.starts_with(name + " ")) continue;
      return line.substr(line.find_first_not_of(' ', name.size()));
    }
    return {};
  }

  /// Bytes of a buffer, -1: it is not there.
  [[nodiscard]] long bytes(const std::string& name) const { return number(of("Buffers", name)); }

  /// "1,234 bytes": 1234.
  static long number(std::string text) {
    std::erase(text, ',');
    long value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

 private:
  std::string text_;
};

TEST(Plan, OfABoardThatTears) {
  const Plan plan({});
  EXPECT_EQ(plan.of("Problem", "nodes, tetrahedra"), "242, 500");
  EXPECT_EQ(plan.of("Problem", "unknowns"), "660 (66 held by supports, 0 driven by grips)");
  EXPECT_EQ(plan.of("Engine", "route"), "inverse, update deferred");
  EXPECT_EQ(plan.of("Engine", "why"),
            "660 unknowns: the dense inverse takes 3484 kB, and a frame reads only its loaded and "
            "torn columns");

  EXPECT_EQ(plan.bytes("inverse (dense, n x n)"), static_cast<long>(kUnknowns * kUnknowns * 8));
  EXPECT_EQ(plan.bytes("element stress"), static_cast<long>(kElements * 6 * 8));
  // u, f; at all nodes: displacement now and next, nodal forces, room.
  EXPECT_EQ(plan.bytes("displacement and forces"),
            static_cast<long>(4 * 3 * kNodes * 8 + 2 * kUnknowns * 8));
  long sum = 0;
  for (const std::string& line : plan.under("Buffers")) {
    if (line.starts_with("predicted memory")) continue;
    const std::size_t value = line.find_last_of(' ', line.find(" bytes (") - 1);
    const long bytes = Plan::number(line.substr(value + 1));
    EXPECT_GT(bytes, 0) << line;
    sum += bytes;
  }
  EXPECT_EQ(plan.bytes("predicted memory"), sum);

  const std::string ms = plan.of("Engine", "predicted frame [ms]");
  double quiet = 0, fracture = 0;
  ASSERT_EQ(std::sscanf(ms.c_str(), "%lf quiet, %lf with a fracture", &quiet, &fracture), 2) << ms;
  EXPECT_GT(quiet, 0);
  EXPECT_GT(fracture, quiet);
}

// By what a step of motion is made of: back-solves with their passes over the elements, and the
// base beside it, which takes longer than any of them.
TEST(Plan, SaysWhatMotionCosts) {
  for (const char* scene : {"motion/board.toml", "finite/liver.toml"}) {
    const Plan plan({}, scene);
    const auto cost = [&](const std::string& kernel) {
      const std::string does = plan.of("Kernels of a frame", kernel);
      const std::size_t at = does.find("about ");
      return at == std::string::npos ? 0 : std::strtod(does.c_str() + at + 6, nullptr);
    };
    const double forces = cost("internal forces"), base = cost("base"), fresh = cost("new base");
    EXPECT_GT(forces, 0) << plan.text();
    EXPECT_GT(base, 0);
    EXPECT_GT(fresh, 5 * base);
    const std::string ms = plan.of("Engine", "predicted frame [ms]");
    double quiet = 0, torn = 0;
    ASSERT_EQ(std::sscanf(ms.c_str(), "%lf quiet, %lf with a fracture", &quiet, &torn), 2) << ms;
    EXPECT_GT(quiet, 5 * (forces + base));
    EXPECT_LT(quiet, 12 * (forces + base));
    EXPECT_GT(torn, 1.5 * quiet);
  }
}

TEST(Plan, NamesTheKernelsOfTheRoute) {
  struct Kernel {
    const char *route, *name, *says;  ///< nothing said: it is not there
  };
  const Kernel kernels[] = {
      {"inverse", "load columns", "6 loaded columns of the inverse, 660 x 660"},
      {"inverse", "damage columns", "660 values each"},
      {"inverse", "new base", "on a thread"},
      {"inverse", "forward solve", nullptr},
      {"inverse", "product K u", nullptr},
      {"factor", "forward solve", "of the load along its elimination path"},
      {"factor", "small update", "along its elimination path"},
      {"factor", "backward solve", "of load and damage"},
      {"factor", "load columns", nullptr},
      {"cg", "product K u", "500 elements"},
      {"cg", "new base", nullptr},
      {"cg", "small update", nullptr},
  };
  std::string route;
  std::optional<Plan> plan;
  for (const Kernel& k : kernels) {
    if (route != k.route) plan.emplace(std::vector{"solver.route=\"" + (route = k.route) + "\""});
    const std::string does = plan->of("Kernels of a frame", k.name);
    if (k.says) {
      EXPECT_TRUE(mentions(does, k.says)) << route << ", " << k.name << ": " << does;
    } else {
      EXPECT_EQ(does, "") << route << ", " << k.name;
    }
    EXPECT_TRUE(mentions(plan->of("Kernels of a frame", "stress"), "500 elements")) << route;
    EXPECT_EQ(plan->of("Kernels of a frame", "grips"), "") << "nothing is gripped";
  }
}

TEST(Plan, NamesNoKernelThatTheSceneDoesNotNeed) {
  const std::string title = "Kernels of a frame", out = "Left out: this scene does not need it";
  const auto left_out = [&](const Plan& plan, const std::string& what) {
    for (const std::string& line : plan.under(out)) {
      if (line.starts_with("- " + what)) return true;
    }
    return false;
  };
  const Plan b({});
  EXPECT_TRUE(mentions(b.of(title, "intact body's field"), "once a step that breaks"));
  EXPECT_TRUE(mentions(b.of(title, "yield summary"), "largest ratio"));
  EXPECT_TRUE(left_out(b, "pressure terms K_b, K_c: no pressing instrument"));
  EXPECT_TRUE(left_out(b, "compliance block of grips"));
  EXPECT_FALSE(left_out(b, "update of the inverse"));
  EXPECT_FALSE(left_out(b, "stress"));

  const Plan a({"fracture.model=\"A\""});
  EXPECT_EQ(a.of(title, "intact body's field"), "");
  EXPECT_TRUE(left_out(a, "intact body's field: only model B reads it"));

  const std::vector<std::string> quiet = {"fracture.model=\"none\"", "destroy=[]"};
  const Plan still(quiet);
  EXPECT_EQ(still.of("Engine", "route"), "factor, update none");
  EXPECT_TRUE(mentions(still.of("Engine", "why"), "nothing can be destroyed"));
  EXPECT_EQ(still.of("Engine", "predicted frame [ms]").find("with a fracture"), std::string::npos);
  for (const char* name : {"small update", "damage forces", "new base", "intact body's field"}) {
    EXPECT_EQ(still.of(title, name), "");
  }
  EXPECT_TRUE(left_out(still, "update of the inverse: nothing can be destroyed"));
  EXPECT_EQ(still.bytes("small matrix of the damage"), -1);
  EXPECT_EQ(still.bytes("element stress"), static_cast<long>(kElements * 6 * 8));

  std::vector<std::string> least = quiet;
  least.push_back("output.fields=[\"displacement\"]");
  const Plan moved(least);
  EXPECT_TRUE(mentions(moved.of(title, "stress"), "their norm alone, for the error estimate"));
  EXPECT_EQ(moved.of(title, "yield summary"), "");
  EXPECT_EQ(moved.bytes("element stress"), -1);
  EXPECT_TRUE(left_out(moved, "stress of each element: no fracture model and no output needs it"));
  EXPECT_TRUE(left_out(moved, "yield summary"));
}

TEST(Plan, CountsGrips) {
  const Plan plan(
      {"instrument=[{ name = \"grip\", kind = \"expansion\", displacement = [0, -1, 0], "
       "box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]] }]"});
  EXPECT_EQ(plan.of("Problem", "unknowns"), "660 (66 held by supports, 6 driven by grips)");
  EXPECT_TRUE(mentions(plan.of("Kernels of a frame", "grips"), "hold 6 unknowns"));
  EXPECT_EQ(plan.bytes("compliance columns of grips"), static_cast<long>(6 * kUnknowns * 8));
  for (const std::string& line : plan.under("Left out: this scene does not need it")) {
    EXPECT_FALSE(mentions(line, "grips")) << line;
  }
}

// One tetrahedron of which one node may move along one axis.
TEST(Plan, SaysOneUnknown) {
  const TempFolder folder;
  write_text(folder / "one.msh",
             "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 0 1 4 1 2 3 4\n"
             "$ENDELM\n");
  write_text(folder / "one.toml",
             "mesh = \"one.msh\"\n[material.volume]\nyoung = 1.0\npoisson = 0.3\n"
             "[[fixed]]\nnodes = [0, 1, 2]\n[[fixed]]\nnodes = [3]\naxes = \"xy\"\n"
             "[[instrument]]\nkind = \"expansion\"\nnodes = [3]\nforce = [0, 0, 0.001]\n");
  const std::vector<std::string> scene = {(folder / "one.toml").string(), "--backend", "cpu"};
  const std::string out = (folder / "o").string();
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"plan"}, {"run", "--out", out}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), scene.begin(), scene.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(mentions(outcome.out, "1 unknown")) << outcome.out;
    for (const std::string& text : {outcome.out, outcome.err})
      for (const char* wrong : {"1 unknowns", "1 tetrahedra"})
        EXPECT_FALSE(mentions(text, wrong)) << text;
  }
  EXPECT_FALSE(mentions(read_file(folder / "o/index.html"), "1 unknowns"));
}

}  // namespace
}  // namespace sunder::test
