// SPDX-License-Identifier: Apache-2.0
#include "app/input/child_process.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <thread>

namespace sunder::test {
namespace {

using End = app::ChildOutcome::End;

TEST(ChildProcess, HandsTheResultBack) {
  const std::string large(5'000'000, 'x');  // more than a pipe holds
  const app::ChildOutcome outcome = app::run_in_child(
      [&] {
        std::fputs("to nobody", stdout);
        std::fputs("a remark", stderr);
        std::fflush(nullptr);
        return large;
      },
      {});
  EXPECT_EQ(outcome.end, End::done);
  EXPECT_EQ(outcome.result, large);
  EXPECT_EQ(outcome.error_text, "a remark");
}

TEST(ChildProcess, OutlivesACrash) {
  const app::ChildOutcome outcome = app::run_in_child(
      []() -> std::string {
        ::raise(SIGKILL);
        return "";
      },
      {});
  EXPECT_EQ(outcome.end, End::crashed);
  EXPECT_EQ(outcome.signal, SIGKILL);
}

TEST(ChildProcess, OutlivesAnUncaughtException) {
  const auto work = []() -> std::string { throw 7; };
  EXPECT_EQ(app::run_in_child(work, {}).end, End::crashed);
}

TEST(ChildProcess, StopsAHang) {
  app::ChildLimits limits;
  limits.timeout = std::chrono::milliseconds(50);
  const auto begin = std::chrono::steady_clock::now();
  const app::ChildOutcome outcome = app::run_in_child(
      []() -> std::string {
        while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
      },
      limits);
  EXPECT_EQ(outcome.end, End::timed_out);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(ChildProcess, StopsAHungerForMemory) {
  const auto hungry = []() -> std::string { throw std::bad_alloc(); };
  EXPECT_EQ(app::run_in_child(hungry, {}).end, End::out_of_memory);
  if (!app::kLimitsMemory) return;  // sanitizers reserve more than any limit
  app::ChildLimits limits;
  limits.memory_bytes = 64U << 20U;
  const auto large = []() -> std::string { return std::string(256U << 20U, 'x').substr(0, 1); };
  EXPECT_EQ(app::run_in_child(large, limits).end, End::out_of_memory);
}

}  // namespace
}  // namespace sunder::test
