// SPDX-License-Identifier: Apache-2.0
// Commands, options and exit codes of docs/interface.md "Program".
#include <gtest/gtest.h>

#include <algorithm>

#include "app/output/program.hpp"
#include "app/output/variable.hpp"

namespace sunder::test {
namespace {

using Arguments = std::vector<std::string>;

struct WrongUsage {
  const char* name;
  Arguments arguments;
  std::string message;  ///< part of it
};

void PrintTo(const WrongUsage& usage, std::ostream* out) { *out << usage.name; }

class WrongUsageTest : public ::testing::TestWithParam<WrongUsage> {};

TEST_P(WrongUsageTest, IsOneSentenceAndExitCode2) {
  const Outcome run = run_program(GetParam().arguments);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err.find("sunder: error: "), 0u) << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
  EXPECT_NE(run.err.find(GetParam().message), std::string::npos) << run.err;
}

const std::string kCommands =
    R"(allowed is "run", "plan", "view", "sweep", "reproduce", "mesh", "devices", "materials" or "help")";

INSTANTIATE_TEST_SUITE_P(
    All, WrongUsageTest,
    ::testing::Values(
        WrongUsage{"nothing", {}, "sunder needs a command; " + kCommands},
        WrongUsage{"command", {"runn"}, "sunder has no command \"runn\"; " + kCommands},
        WrongUsage{"empty_command", {""}, kCommands},
        WrongUsage{"option", {"-z"}, "sunder has no option \"-z\""},
        WrongUsage{"run_without_scene", {"run"}, "SCENE.toml is required"},
        WrongUsage{"run_option",
                   {"run", "a.toml", "--rout", "cg"},
                   "no option \"--rout\", perhaps --route was meant"},
        WrongUsage{"two_scenes", {"run", "a.toml", "b.toml"}, "no further argument \"b.toml\""},
        WrongUsage{"no_value", {"run", "a.toml", "--route"}, "--route takes exactly one value"},
        WrongUsage{"twice",
                   {"run", "a.toml", "--steps", "1", "--steps", "2"},
                   "--steps takes exactly one value"},
        WrongUsage{
            "route",
            {"run", "a.toml", "--route", "lu"},
            R"(--route is "lu"; allowed is "auto", "inverse", "condensed", "factor" or "cg")"},
        WrongUsage{"update",
                   {"plan", "a.toml", "--update", "lazy"},
                   R"(--update is "lazy"; allowed is "auto", "eager" or "deferred")"},
        WrongUsage{"precision",
                   {"run", "a.toml", "--precision", "fp16"},
                   R"(--precision is "fp16"; allowed is "auto", "fp32" or "fp64")"},
        WrongUsage{"backend",
                   {"run", "a.toml", "--backend", "cuda"},
                   R"(--backend is "cuda"; allowed is "auto", "cpu" or "vulkan")"},
        WrongUsage{"device", {"run", "a.toml", "--device", "-1"}, "--device is \"-1\"; allowed is"},
        WrongUsage{"steps_zero",
                   {"run", "a.toml", "--steps", "0"},
                   "--steps is \"0\"; allowed is a whole number from 1"},
        WrongUsage{"steps_word", {"run", "a.toml", "--steps", "4x"}, "--steps is \"4x\""},
        WrongUsage{"steps_huge",
                   {"run", "a.toml", "--steps", "99999999999"},
                   "--steps is \"99999999999\""},
        WrongUsage{"snapshots",
                   {"run", "a.toml", "--snapshots", "5,,7"},
                   "--snapshots is \"5,,7\"; allowed is a list of whole numbers"},
        WrongUsage{"snapshots_zero", {"run", "a.toml", "--snapshots", "0"}, "--snapshots is \"0\""},
        WrongUsage{"snapshots_empty", {"run", "a.toml", "--snapshots", ""}, "--snapshots is \"\""},
        WrongUsage{"set",
                   {"run", "a.toml", "--set", "time.steps"},
                   "--set is \"time.steps\"; allowed is KEY.PATH=VALUE"},
        WrongUsage{"out_empty", {"run", "a.toml", "--out", ""}, "--out is \"\""},
        WrongUsage{"sweep_jobs",
                   {"sweep", "a.toml", "--out", "x", "--jobs", "two"},
                   "--jobs is \"two\"; allowed is a whole number from 1"},
        WrongUsage{"sweep_threads",
                   {"sweep", "a.toml", "--out", "x", "--jobs", "99999"},
                   "--jobs is \"99999\"; allowed are at most 1024"},
        WrongUsage{"sweep_part",
                   {"sweep", "a.toml", "--out", "x", "--part", "0/2"},
                   "--part is \"0/2\"; allowed is I/N"},
        WrongUsage{"sweep_out", {"sweep", "a.toml", "--vary", "a=1"}, "needs --out"},
        WrongUsage{"sweep_vary",
                   {"sweep", "a.toml", "--out", "x"},
                   "a sweep needs --vary; allowed is KEY.PATH=A,B,C"},
        WrongUsage{"mesh", {"mesh"}, "sunder mesh needs a command; allowed is \"board\""},
        WrongUsage{"mesh_cube", {"mesh", "cube"}, "no command \"cube\"; allowed is \"board\""},
        WrongUsage{"mesh_file", {"mesh", "board"}, "--output is required"},
        WrongUsage{"mesh_nx", {"mesh", "board", "--nx", "0", "-o", "x.msh"}, "--nx is \"0\""},
        WrongUsage{"mesh_thickness",
                   {"mesh", "board", "--thickness", "nan", "-o", "x.msh"},
                   "--thickness is \"nan\"; allowed is a finite number above 0"},
        WrongUsage{"mesh_ascii",
                   {"mesh", "board", "--nx", "4", "--ascii", "-o", "x.vtk"},
                   "--ascii is for .msh alone; -o is x.vtk"},
        WrongUsage{"devices", {"devices", "all"}, "no further argument \"all\""},
        WrongUsage{"help", {"help", "fly"}, "\"fly\"; " + kCommands}),
    [](const auto& test) { return test.param.name; });

TEST(CommandLine, HelpAndVersion) {
  EXPECT_EQ(run_program({"--version"}).out, "sunder " SUNDER_VERSION "\n");
  for (const Arguments& arguments :
       {Arguments{"--help"}, Arguments{"help"}, Arguments{"help", "run"}, Arguments{"run", "-h"},
        Arguments{"help", "mesh", "board"}}) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_NE(run.out.find("Usage: sunder"), std::string::npos) << run.out;
    EXPECT_EQ(run.err, "");
  }
  const std::string run_help = run_program({"help", "run"}).out;
  for (const char* option : {"--out", "--backend", "--device", "--route", "--update", "--precision",
                             "--steps", "--series", "--snapshots", "--set", "--quiet"})
    EXPECT_NE(run_help.find(option), std::string::npos) << option;
}

TEST(CommandLine, MeshBoardIsATextWhereAscii) {
  const TempFolder folder;
  const auto board = [&](Arguments more) {
    Arguments arguments = {"mesh", "board", "--nx", "1", "--ny", "4", "--nz", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"-o", (folder / "b.msh").string()});
    EXPECT_EQ(run_program(arguments).exit_code, 0);
    return read_file(folder / "b.msh");
  };
  const auto is_text = [](const std::string& bytes) {
    return std::all_of(bytes.begin(), bytes.end(),
                       [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
  };
  const std::string text = board({"--ascii"}), binary = board({});
  EXPECT_EQ(text.find("$MeshFormat\n4.1 0 8\n"), 0u);
  EXPECT_TRUE(is_text(text));
  EXPECT_EQ(binary.find("$MeshFormat\n4.1 1 8\n"), 0u);
  EXPECT_FALSE(is_text(binary));
}

TEST(CommandLine, DevicesListsTheCpu) {
  const Outcome run = run_program({"devices"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("cpu"), std::string::npos);
  EXPECT_NE(run.out.find("fp64"), std::string::npos);
}

TEST(CommandLine, MaterialsListsTissuesWithTheirSources) {
  const Outcome run = run_program({"materials"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("liver-porcine: liver of pigs\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("  energy     0.051 N/mm        51 +- 6 J/m^2, peeled along the "
                         "circumference (Sommer et al. 2008)\n"),
            std::string::npos)
      << run.out;
}

TEST(CommandLine, ExitCodesTellWhoseFaultItIs) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const std::string scene = board.scene.string(), out = (folder / "o").string();
  const auto exit_code = [&](Arguments more) {
    Arguments arguments = {"run", scene, "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments).exit_code;
  };
  EXPECT_EQ(run_program({"run", (folder / "none.toml").string()}).exit_code, 3);
  EXPECT_EQ(exit_code({"--set", "fracture.colour=1"}), 3);
  EXPECT_EQ(exit_code({"--set", "material.upper.young=-5"}), 3);
  EXPECT_EQ(exit_code({"--backend", "cpu", "--device", "99"}), 4);
  EXPECT_FALSE(std::filesystem::exists(out)) << "bad input must not leave a result folder";
}

TEST(CommandLine, OutMustBeAFolder) {
  const TempFolder folder;
  const TearingBoard board(folder);
  write_text(folder / "file", "x");
  for (const auto& out :
       {folder / "file", folder / "file/below", std::filesystem::path("/proc/x")}) {
    const Outcome run = run_program({"run", board.scene.string(), "--out", out.string()});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("--out: results cannot go to " + out.string()), std::string::npos)
        << run.err;
  }
  EXPECT_EQ(read_file(folder / "file"), "x");
}

TEST(CommandLine, OutWithANameThatIsTooLong) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const std::string name(300, 'n'), deep = (folder / "made" / name / "below").string();
  for (const std::string& out : {(folder / name).string(), deep}) {
    const Outcome run = run_program({"run", board.scene.string(), "--out", out});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("--out: results cannot go to " + out + ": File name too long"),
              std::string::npos)
        << run.err;
  }
}

// What was dropped says what takes its place, whether a flag or the scene asks for it.
TEST(CommandLine, DroppedWaysNameWhatTakesTheirPlace) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const std::string scene = board.scene.string(), out = (folder / "o").string();
  const std::string condensed =
      "route condensed has the update deferred only; use update deferred or auto, or route inverse";
  const std::string single = "backend cpu computes in fp64 only; use precision fp64 or auto";
  struct Dropped {
    Arguments flags, keys;
    std::string says;
  };
  for (const Dropped& dropped :
       {Dropped{{"--route", "condensed", "--update", "eager"},
                {"--set", "solver.route=\"condensed\"", "--set", "solver.update=\"eager\""},
                condensed},
        Dropped{{"--precision", "fp32", "--update", "eager"},
                {"--set", "solver.precision=\"fp32\"", "--set", "solver.update=\"eager\""},
                single}}) {
    for (const Arguments& asked : {dropped.flags, dropped.keys}) {
      for (const char* command : {"run", "plan"}) {
        Arguments arguments = {command, scene, "--backend", "cpu", "--out", out};
        arguments.insert(arguments.end(), asked.begin(), asked.end());
        const Outcome refused = run_program(arguments);
        EXPECT_EQ(refused.exit_code, 4) << refused.err;
        EXPECT_NE(refused.err.find(dropped.says), std::string::npos) << refused.err;
      }
    }
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(CommandLine, QuietSaysNothingOnStderr) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const Arguments run = {"run", board.scene.string(), "--out", (folder / "o").string()};
  EXPECT_NE(run_program(run).err.find("sunder: warning: "), std::string::npos);
  Arguments quiet = run;
  quiet.push_back("--quiet");
  const Outcome outcome = run_program(quiet);
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("results in "), std::string::npos);
}

TEST(CommandLine, SetAndStepsOverrideTheScene) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "o";
  const Outcome run = run_program({"run", board.scene.string(), "--out", out.string(), "--set",
                                   "instrument.0.force=[0,-3,0]", "--set", "title=\"Light pull\"",
                                   "--set", "time.steps=7", "--steps", "2", "--route", "cg"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = read_json(out / "summary.json");
  EXPECT_EQ(summary["title"], "Light pull");
  EXPECT_EQ(summary["steps"], 2);  // the option wins over --set
  EXPECT_EQ(summary["route"]["name"], "cg");
  EXPECT_EQ(summary["reactions"]["right forceps"][1], -3);
  EXPECT_EQ(summary["first_rupture"], nullptr);
}

TEST(CommandLine, PlanSaysWhatIsNeededAndLeftOut) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const Variable nowhere("SUNDER_CACHE_DIR", "");  // where a GPU is there
  const Outcome plan = run_program(
      {"plan", board.scene.string(), "--set", "fracture.model=none", "--set", "destroy=[]"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  for (const char* part :
       {"242, 500", "660 (66 held by supports", "predicted memory", " bytes (", "route", "why",
        "predicted frame [ms]", "Operations of a frame", "Left out"})
    EXPECT_NE(plan.out.find(part), std::string::npos) << part << "\n" << plan.out;
  EXPECT_EQ(plan.out.find("destroy:"), std::string::npos) << plan.out;
  const Outcome torn = run_program({"plan", board.scene.string()});
  EXPECT_NE(torn.out.find("destroy: update"), std::string::npos) << torn.out;
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"board.msh", "torn.toml"}));
}

TEST(ExitCode, OfWhatAScenesMeshCannotHaveIsThree) {
  const TempFolder folder;
  const std::string scenes = SUNDER_SOURCE "/scenes/";
  const struct {
    std::string scene, change, message;
  } cases[] = {{"finite/skin-wounds.toml", "material.skin.fibres.direction=[0, 0, 0]",
                "fibres 0 has direction = [0, 0, 0]; it must be finite and not zero"},
               {"finite/skin-wounds.toml", R"(material.skin.fibres={field="helix", k1=1, k2=1})",
                "field = \"helix\", which is no vector of the mesh's cells; its file has none"},
               {"peel/artery.toml", R"(interface.0.between=["artery", "membrane"])",
                "lies nowhere: the two volumes share no face"}};
  for (const auto& bad : cases) {
    const Outcome run = run_program(
        {"run", scenes + bad.scene, "--set", bad.change, "--out", (folder / "out").string()});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_NE(run.err.find(bad.message), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace sunder::test
