#include "pipeline/process/forked_trial.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace npdr::pipeline {
namespace {

TEST(ForkedTrial, TellsACrashFromAnEnd) {
  EXPECT_TRUE(survives([] {}));
  EXPECT_TRUE(survives([] { throw std::runtime_error("no crash"); }));
  EXPECT_FALSE(survives([] { std::raise(SIGSEGV); }));
  EXPECT_FALSE(survives([] { std::abort(); }));
  EXPECT_FALSE(survives([] { std::raise(SIGXCPU); })) << "it never ends";
  EXPECT_FALSE(survives([] { std::_Exit(1); })) << "a sanitizer found an error";
}

TEST(ForkedTrial, WhatNeverEndsIsACrash) {
  EXPECT_FALSE(survives([] { pause(); }, 1));
}

TEST(ForkedTrial, WhatComesFromOutsideIsNoCrash) {
  EXPECT_TRUE(survives([] { std::raise(SIGKILL); }));
}

TEST(ForkedTrial, LeavesThisProcessAsItWas) {
  int value = 1;
  EXPECT_TRUE(survives([&] { value = 2; }));
  EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace npdr::pipeline
