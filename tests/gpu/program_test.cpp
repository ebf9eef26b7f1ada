// SPDX-License-Identifier: Apache-2.0
// The program on Vulkan as a user starts it, under validation as every test here; and what it does
// on machines without a loader, without a driver, without a GPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>

#include "app/output/program.hpp"
#include "app/output/variable.hpp"

namespace sunder::test {
namespace {

struct Board {
  TempFolder folder;
  TearingBoard board{folder};

  [[nodiscard]] Outcome run(const std::string& out, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"run", board.scene.string(), "--quiet", "--out",
                                          (folder / out).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  /// events.csv without its floating-point columns, which follow the precision.
  [[nodiscard]] std::vector<std::vector<std::string>> events(const std::string& out) const {
    auto rows = read_csv(folder / out / "events.csv");
    for (auto& row : rows) row.resize(5);  // step, event, element, criterion, crack
    return rows;
  }
  [[nodiscard]] nlohmann::ordered_json summary(const std::string& out) const {
    return read_json(folder / out / "summary.json");
  }
  /// Those of its warnings that speak of a backend.
  [[nodiscard]] std::vector<std::string> of_backend(const std::string& out) const {
    std::vector<std::string> found;
    const auto all = summary(out)["warnings"].get<std::vector<std::string>>();
    std::copy_if(all.begin(), all.end(), std::back_inserter(found),
                 [](const std::string& text) { return text.find("backend") != std::string::npos; });
    return found;
  }
};

class Program : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
  }
};

TEST_F(Program, TearsTheBoardAsOnTheCpuByEveryRouteAndPrecision) {
  const Board board;
  ASSERT_EQ(board.run("cpu", {"--backend", "cpu"}).exit_code, 0);
  ASSERT_GE(board.events("cpu").size(), 10u);
  using Options = std::vector<std::string>;
  const Options ways[] = {{"--precision", "fp32"},
                          {"--precision", "fp64"},
                          {"--precision", "fp64", "--update", "eager"},
                          {"--precision", "fp64", "--route", "cg"}};
  for (const char* variant : {"gpu", "lvp"}) {
    const Variable chosen("SUNDER_SHADER_VARIANT", variant);
    for (Options options : ways) {
      SCOPED_TRACE(variant + (" " + options[1]) + (options.size() > 2 ? " " + options[3] : ""));
      options.insert(options.end(), {"--backend", "vulkan"});
      const Outcome run = board.run("vulkan", options);
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_EQ(board.events("vulkan"), board.events("cpu"));
      EXPECT_EQ(board.summary("vulkan")["device"]["backend"], "vulkan");
      EXPECT_EQ(board.summary("vulkan")["device"]["precision"], options[1]);
    }
  }
}

TEST_F(Program, PlansThePipelinesOfAScene) {
  const Board board;
  const Variable chosen("SUNDER_SHADER_VARIANT", "lvp");
  const auto plan = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "plan", board.board.scene.string(), "--backend", "vulkan", "--precision", "fp64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const auto says = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string torn = plan({});
  EXPECT_TRUE(says(torn, "660 (66 held by supports")) << torn;
  EXPECT_TRUE(says(torn, "inverse, update deferred")) << torn;
  EXPECT_TRUE(says(torn, "660 unknowns: the dense inverse takes 3484 kB")) << torn;
  // 500 elements, padded to 512, eight values each.
  EXPECT_TRUE(says(torn, "element stress (device)           32,768 bytes")) << torn;
  EXPECT_TRUE(says(torn, "\n  stress_lvp_fp64 ")) << torn;
  EXPECT_TRUE(says(torn, "\n  solve_lvp_fp64 ")) << torn;
  EXPECT_FALSE(says(torn, "\n  cg_")) << torn;
  EXPECT_FALSE(says(torn, "\n  hold_")) << torn;
  const std::size_t ms = torn.find("predicted frame [ms]");
  double quiet = 0, fracture = 0;
  ASSERT_EQ(
      std::sscanf(torn.c_str() + ms, "predicted frame [ms] %lf quiet, %lf with", &quiet, &fracture),
      2);
  EXPECT_GT(quiet, 0);
  EXPECT_GT(fracture, quiet);
  EXPECT_TRUE(says(plan({"--route", "cg"}), "\n  cg_step_lvp_fp64 "));
  const std::string still = plan({"--set", "fracture.model=none", "--set", "destroy=[]", "--set",
                                  "output.fields=[\"displacement\"]"});
  EXPECT_FALSE(says(still, "\n  stress_")) << still;
  EXPECT_TRUE(says(still, "- stress of each element: no fracture model and no output needs it"))
      << still;
}

TEST_F(Program, GivesTheSameBytesAgain) {
  const Board board;
  for (const char* precision : {"fp32", "fp64"}) {
    for (const char* out : {"one", "two"}) {
      ASSERT_EQ(board.run(out, {"--backend", "vulkan", "--precision", precision}).exit_code, 0);
    }
    for (const char* file : {"events.csv", "result.vtu", "figure.svg"}) {
      EXPECT_TRUE(read_file(board.folder / "one" / file) == read_file(board.folder / "two" / file))
          << file << " in " << precision;
    }
  }
}

const char* const kPasses[] = {"solve", "stress", "residual", "estimate", "refine", "update"};

/// ms_gpu_* of a run's steps, by pass; checked to be numbers that fit into the step.
std::map<std::string, std::vector<double>> gpu_times(const std::filesystem::path& frames) {
  const auto rows = read_csv(frames);
  const auto column = [&](const std::string& name) {
    const auto found = std::find(rows.front().begin(), rows.front().end(), name);
    EXPECT_NE(found, rows.front().end()) << name;
    return static_cast<std::size_t>(found - rows.front().begin());
  };
  std::map<std::string, std::vector<double>> times;
  for (std::size_t step = 1; step < rows.size(); ++step) {
    double sum = 0;
    for (const char* pass : kPasses) {
      const std::string& cell = rows[step].at(column(std::string("ms_gpu_") + pass));
      const double ms = std::strtod(cell.c_str(), nullptr);
      EXPECT_FALSE(cell.empty()) << pass;
      EXPECT_TRUE(std::isfinite(ms) && ms >= 0) << pass << ": " << cell;
      sum += times[pass].emplace_back(ms);
    }
    // The passes lie within the step, whose clock is another one.
    const double total = std::strtod(rows[step].at(column("ms_total")).c_str(), nullptr);
    EXPECT_LE(sum, 1.05 * total + 0.1) << "step " << step;
  }
  return times;
}

TEST_F(Program, TellsTheDevicesTimeOfEachPass) {
  struct Ran {
    std::vector<std::string> options;
    std::vector<std::string> passes;  ///< that some step of the torn board runs
  };
  const Ran all[] = {
      {{"--precision", "fp32"}, {"residual"}},
      {{"--precision", "fp64", "--update", "eager", "--route", "inverse"}, {"estimate", "update"}},
      {{"--precision", "fp64", "--route", "cg"}, {"residual", "estimate"}},
  };
  const Board board;
  for (Ran ran : all) {
    SCOPED_TRACE(ran.options.back());
    ran.options.insert(ran.options.end(), {"--backend", "vulkan"});
    const Outcome run = board.run("vulkan", ran.options);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    auto times = gpu_times(board.folder / "vulkan" / "frames.csv");
    for (const char* pass : {"solve", "stress"}) {
      ASSERT_EQ(times[pass].size(), 5u);
      for (double ms : times[pass]) EXPECT_GT(ms, 0) << pass;
    }
    for (const std::string& pass : ran.passes) {
      EXPECT_GT(*std::max_element(times[pass].begin(), times[pass].end()), 0) << pass;
    }
  }
}

TEST_F(Program, LeavesTheDevicesTimesEmptyOnTheCpu) {
  const Board board;
  ASSERT_EQ(board.run("cpu", {"--backend", "cpu"}).exit_code, 0);
  const auto rows = read_csv(board.folder / "cpu" / "frames.csv");
  ASSERT_EQ(rows.size(), 6u);
  for (std::size_t c = 0; c < rows[0].size(); ++c) {
    if (rows[0][c].find("ms_gpu_") != 0) continue;
    for (std::size_t step = 1; step < rows.size(); ++step) EXPECT_EQ(rows[step][c], "");
  }
}

TEST_F(Program, PlanMeasuresThePassesOfTheFirstSteps) {
  const Board board;
  const Outcome plan =
      run_program({"plan", board.board.scene.string(), "--measure", "--backend", "vulkan"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  const std::size_t measured = plan.out.find("Measured [ms], the first steps\n");
  ASSERT_NE(measured, std::string::npos) << plan.out;
  std::istringstream lines(plan.out.substr(measured));
  int steps = 0, devices = 0;
  for (std::string line; std::getline(lines, line);) {
    steps += line.find("  step ") == 0 && line.find(", total ") != std::string::npos;
    if (line.find("    device ") != 0) continue;
    ++devices;
    for (const std::string pass : {"solve", "stress"}) {
      const std::size_t at = line.find(pass + " ");
      ASSERT_NE(at, std::string::npos) << line;
      const double ms = std::strtod(line.c_str() + at + pass.size(), nullptr);
      EXPECT_TRUE(std::isfinite(ms) && ms > 0) << line;
    }
  }
  EXPECT_EQ(steps, 5) << plan.out;
  EXPECT_EQ(devices, 5) << plan.out;
}

// Once: the next plan takes what is kept, and says the same.
TEST_F(Program, PlansByTheRatesThatItHasMeasured) {
  const Board board;
  const TempFolder kept;
  const Variable here("SUNDER_CACHE_DIR", kept.path().string());
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(kept.path()), {});
  };
  EXPECT_EQ(run_program({"devices"}).out.find("measured:"), std::string::npos);
  const auto predicted = [&](const std::string& backend) {
    const Outcome plan = run_program({"plan", board.board.scene.string(), "--backend", backend});
    EXPECT_EQ(plan.exit_code, 0) << plan.err;
    const std::size_t at = plan.out.find("predicted frame [ms]");
    return plan.out.substr(at, plan.out.find('\n', at) - at);
  };
  EXPECT_EQ(predicted("cpu").find(", by "), std::string::npos);
  EXPECT_EQ(files(), 0) << "backend cpu needs none of it";
  const std::string first = predicted("vulkan");
  EXPECT_NE(first.find(", by rates measured on the device"), std::string::npos) << first;
  EXPECT_GE(files(), 1);
  EXPECT_EQ(predicted("vulkan"), first);
  const std::string list = run_program({"devices"}).out;
  const std::size_t at = list.find(", measured: ");
  ASSERT_NE(at, std::string::npos) << list;
  for (const char* unit : {" us a submit, ", " us a dispatch, ", " GB/s, ", " GFLOP/s"})
    EXPECT_NE(list.find(unit, at), std::string::npos) << list;
  const Outcome again = run_program({"devices", "--measure"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_NE(again.out.find(", measured: "), std::string::npos) << again.out;
  EXPECT_EQ(again.err, "");
}

TEST_F(Program, SaysThatRatesCannotBeKeptOrMeasured) {
  const TempFolder kept;
  std::ofstream(kept / "file") << "no folder";
  {
    const Variable here("SUNDER_CACHE_DIR", (kept / "file").string());
    const Outcome run = run_program({"devices", "--measure"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_NE(run.err.find("cannot be kept in " + (kept / "file").string()), std::string::npos)
        << run.err;
    EXPECT_NE(run.out.find(", measured: "), std::string::npos) << "for this process";
  }
  const Variable here("SUNDER_CACHE_DIR", kept.path().string());
  const Variable lost("SUNDER_VULKAN_PROBE", "lost=3");
  const Outcome run = run_program({"devices", "--measure"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.err.find("cannot be measured: "), std::string::npos) << run.err;
  EXPECT_EQ(run.out.find(", measured: "), std::string::npos) << run.out;
}

TEST_F(Program, RunsUnderTheValidationLayerHere) {
  const Variable debug("VK_LOADER_DEBUG", "layer");
  const Outcome run = run_program({"devices"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.err.find("VK_LAYER_KHRONOS_validation"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("vulkan"), std::string::npos) << run.out;
}

/// What every machine without a Vulkan device does, however that comes about.
void expect_cpu_only(const std::string& reason) {
  const Board board;
  const Outcome asked = board.run("vulkan", {"--backend", "vulkan"});
  EXPECT_EQ(asked.exit_code, 4);
  EXPECT_NE(asked.err.find(reason), std::string::npos) << asked.err;
  const Outcome automatic = board.run("auto", {});
  EXPECT_EQ(automatic.exit_code, 0) << automatic.err;
  EXPECT_EQ(board.summary("auto")["device"]["backend"], "cpu");
  const auto warnings = board.of_backend("auto");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("backend auto found no GPU, cpu is used instead: " + reason), 0u)
      << warnings[0];
  EXPECT_NE(warnings[0].find("; install "), std::string::npos) << warnings[0];
  const Outcome devices = run_program({"devices"});
  EXPECT_EQ(devices.exit_code, 0);
  EXPECT_EQ(devices.out.find("vulkan"), std::string::npos) << devices.out;
}

TEST(ProgramWithout, ADriverTakesTheCpu) {
  const Variable files("VK_DRIVER_FILES", "/nonexistent");
  const Variable icds("VK_ICD_FILENAMES", "/nonexistent");
  expect_cpu_only("no Vulkan driver");
}

TEST(ProgramWithout, ALoaderTakesTheCpu) {
  const TempFolder folder;
  write_text(folder / "libvulkan.so.1", "no library");  // found first, and not what it seems
  const Variable path("LD_LIBRARY_PATH", folder.path().string());
  expect_cpu_only("no Vulkan loader was found");
}

TEST_F(Program, AutoTakesTheCpuWhereTheOnlyDeviceIsAProcessor) {
  const Outcome devices = run_program({"devices"});
  if (devices.out.find("* vulkan") != std::string::npos) GTEST_SKIP() << "a GPU is there";
  const Board board;
  ASSERT_EQ(board.run("auto", {}).exit_code, 0);
  EXPECT_EQ(board.summary("auto")["device"]["backend"], "cpu");
  EXPECT_TRUE(board.of_backend("auto").empty());
}

TEST_F(Program, AutoTakesAGpu) {
  const Variable probe("SUNDER_VULKAN_PROBE", "as_gpu");
  const Board board;
  ASSERT_EQ(board.run("auto", {}).exit_code, 0);
  EXPECT_EQ(board.summary("auto")["device"]["backend"], "vulkan");
  EXPECT_TRUE(board.of_backend("auto").empty());
}

TEST_F(Program, AutoSaysWhyAGpuThatIsThereIsNotUsed) {
  struct Fault {
    const char *probe, *reason;
  };
  const Fault faults[] = {
      {"as_gpu,no_compute", "cannot be used: it has no compute queue; update its driver or use"},
      {"as_gpu,memory=100000", " has 100000; use route cg"},
      {"as_gpu,lost=0", "the Vulkan device was lost in"},
  };
  const Board board;
  ASSERT_EQ(board.run("cpu", {"--backend", "cpu"}).exit_code, 0);
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.probe);
    const Variable probe("SUNDER_VULKAN_PROBE", fault.probe);
    const Outcome run = board.run("auto", {});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(board.summary("auto")["device"]["backend"], "cpu");
    EXPECT_EQ(board.events("auto"), board.events("cpu"));
    const auto warnings = board.of_backend("auto");
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(", cpu is used instead: "), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(fault.reason), std::string::npos) << warnings[0];
    // By name it is an error.
    const Outcome asked = board.run("vulkan", {"--backend", "vulkan"});
    EXPECT_EQ(asked.exit_code, 4);
    EXPECT_NE(asked.err.find(fault.reason), std::string::npos) << asked.err;
  }
}

TEST_F(Program, ADeviceLostInMidRunIsAWarningAndNothingElseChanges) {
  const Board board;
  ASSERT_EQ(board.run("cpu", {"--backend", "cpu"}).exit_code, 0);
  int submits = 2;
  for (bool in_mid_run = false; !in_mid_run; submits *= 2) {
    ASSERT_LT(submits, 1000);
    const Variable probe("SUNDER_VULKAN_PROBE", "as_gpu,lost=" + std::to_string(submits));
    const Outcome run = board.run("auto", {});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(board.events("auto"), board.events("cpu"));
    EXPECT_EQ(board.summary("auto")["device"]["backend"], "cpu");
    const auto warnings = board.of_backend("auto");
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("the Vulkan device was lost in"), std::string::npos);
    in_mid_run = warnings[0].find("failed in mid-run, cpu took over") != std::string::npos;
    EXPECT_EQ(warnings[0].find("or use backend cpu") != std::string::npos, in_mid_run);
  }
  EXPECT_EQ(read_csv(board.folder / "auto" / "frames.csv").size(), 6u);  // the head and five steps
}

}  // namespace
}  // namespace sunder::test
