#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "tests/faults/fault_study.h"

namespace npdr::pipeline {
namespace {

/// While it lives, a call of the C library fails in the programs that a test starts (see
/// tests/failing_calls).
class FailingCall {
 public:
  FailingCall(const std::string& name, int error) {
    set("LD_PRELOAD", std::string(NPDR_BINARY_DIR) + "/tests/failing_calls/libfailing_calls.so");
    set("ASAN_OPTIONS", "verify_asan_link_order=0");
    set("NPDR_FAIL", name);
    set("NPDR_FAIL_ERRNO", std::to_string(error));
  }
  ~FailingCall() {
    for (const std::string& variable : variables_) ::unsetenv(variable.c_str());
  }
  FailingCall(const FailingCall&) = delete;
  FailingCall& operator=(const FailingCall&) = delete;

  void set(const std::string& variable, const std::string& value) {
    ::setenv(variable.c_str(), value.c_str(), 1);
    variables_.push_back(variable);
  }

 private:
  std::vector<std::string> variables_;
};

class FailingCalls : public Faults {
 protected:
  // A posterior that is made of simulations.
  static Artefact posterior() {
    std::vector<Artefact> all = folder_->artefacts_of("infer");
    return *std::ranges::find_if(
        all, [](const Artefact& a) { return a.label.find("MoG") != std::string::npos; });
  }
};

// Whatever keeps a good file from being read, nobody is to remove it.
TEST_F(FailingCalls, WhatCannotBeReadJustNowIsNotCalledDamaged) {
  const Artefact reader = posterior();
  for (const std::string call : {"open", "pread"}) {
    for (const int error : {EMFILE, EACCES, EIO, EAGAIN}) {
      std::filesystem::remove(reader.path);
      FailingCall failing(call, error);
      failing.set("NPDR_FAIL_UNDER", ".cache/simulate");
      const Outcome failed = run(folder_->path(), FaultFolder::making(reader));
      EXPECT_EQ(failed.status, 1) << call << " " << error << ": " << failed.err;
      EXPECT_FALSE(has(failed.err, "remove"));
      EXPECT_TRUE(has(failed.err, ".h5"));
      failing.set("NPDR_FAIL_UNDER", ".cache");
      const Outcome status = folder_->npdr({"status", "--check"});
      EXPECT_FALSE(has(status.out, "remove"));
    }
  }
  EXPECT_EQ(folder_->npdr({"run"}).status, 0);
  expect_same_results(*folder_);
}

TEST_F(FailingCalls, AReadThatIsCutShortIsGoneOnWith) {
  const Artefact reader = posterior();
  std::filesystem::remove(reader.path);
  {
    FailingCall failing("pread", 0);
    failing.set("NPDR_FAIL_UNDER", ".cache");
    const Outcome outcome = run(folder_->path(), FaultFolder::making(reader));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_FALSE(has(folder_->npdr({"status", "--check"}).out, "remove"));
  }
  expect_same_results(*folder_);
}

TEST_F(FailingCalls, AFileThatCannotBeClosedIsNamed) {
  const Artefact reader = posterior();
  std::filesystem::remove(reader.path);
  {
    FailingCall failing("close", EIO);
    failing.set("NPDR_FAIL_UNDER", ".cache/simulate");
    const Outcome failed = run(folder_->path(), FaultFolder::making(reader));
    EXPECT_EQ(failed.status, 1) << failed.err;
    EXPECT_TRUE(has(failed.err, ".h5: HDF5 couldn't close this file"));
  }
  EXPECT_EQ(folder_->npdr({"run"}).status, 0);
  expect_same_results(*folder_);
}

// Who waits for a program is told of its end by a signal; without a descriptor left for that, it
// has to look itself.
TEST_F(FailingCalls, TheEndOfAProgramIsNoticedWithoutSignals) {
  const TempFolder folder;
  folder.file("x_o.csv", "a\n0.5\n");
  folder.file("s.toml",
              command_study("s")
                  .with("simulator", {"command = \"cut -d, -f1 {theta} >{x}\"", "time_limit = 30"})
                  .with("prior", {"a = { uniform = [0.0, 1.0] }"})
                  .method("A", {"algorithm = \"abc_rejection\""}));
  ASSERT_EQ(run(folder.path(), {"npdr-propose", "s.toml"}).status, 0);
  FailingCall failing("signalfd", ENFILE);
  failing.set("NPDR_FAIL_NOTE", folder / "note");
  const Program program(folder.path(), {"npdr-simulate", "s.toml"});
  EXPECT_TRUE(program.ends_within(20.0));
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(text_of(folder / "note").starts_with("signalfd")) << "the call is made";
}

// A call and the ways in which it fails; 0: it does half of what it is asked for.
struct CallAndErrors {
  std::string call;
  std::vector<int> errors;
  friend void PrintTo(const CallAndErrors& c, std::ostream* stream) { *stream << c.call; }
};

const std::vector<CallAndErrors> kCases = {
    {"open", {EMFILE, EIO, EINTR}}, {"read", {EIO, EINTR, 0}},
    {"pread", {EIO, EINTR, 0}},     {"write", {ENOSPC, EINTR, 0}},
    {"pwrite", {ENOSPC, EIO, 0}},   {"fsync", {EIO}},
    {"rename", {EIO, ENOSPC}},      {"close", {EIO}}};

// What became of programs in which one call failed.
struct Fates {
  int failures = 0;   // calls
  int unharmed = 0;   // the program went on, to the same bits
  int reported = 0;   // status 1 or 2, with the name of a file
  int killed = 0;     // by a signal, or it hung
  int nameless = 0;   // another status, or no file is named
  int misled = 0;     // somebody was told to remove a good file
  int different = 0;  // other bits, at once or when it is run again

  void operator+=(const Fates& other) {
    failures += other.failures;
    unharmed += other.unharmed;
    reported += other.reported;
    killed += other.killed;
    nameless += other.nameless;
    misled += other.misled;
    different += other.different;
  }
  int bad() const { return killed + nameless + misled + different; }
  std::string row(const std::string& name) const {
    return fmt::format("| {:<22} | {:6} | {:8} | {:8} | {:6} | {:8} | {:6} | {:9} |", name,
                       failures, unharmed, reported, killed, nameless, misled, different);
  }
  static std::string title() {
    return fmt::format("| {:<22} | {:6} | {:8} | {:8} | {:6} | {:8} | {:6} | {:9} |\n|{}|",
                       "failing", "calls", "unharmed", "reported", "killed", "nameless", "misled",
                       "different", ":--|--:|--:|--:|--:|--:|--:|--:");
  }
};

// Every n-th call of each stage fails; all of them with the environment variable
// NPDR_FAULT_CALLS=1, otherwise some.
class EachCall : public Faults, public ::testing::WithParamInterface<CallAndErrors> {
 protected:
  static int next(int n) { return std::getenv("NPDR_FAULT_CALLS") == nullptr ? 8 * n : n + 1; }

  static bool says_where(const std::string& message) {
    return message.find("runs") != std::string::npos ||
           message.find("faults.toml") != std::string::npos ||
           message.find("recording.h5") != std::string::npos;
  }

  // Of each of these stages the artefact that is made in the shortest time.
  static std::vector<Artefact> quickest() {
    const std::vector<Artefact> all = folder_->artefacts();
    std::vector<Artefact> chosen;
    for (const std::string stage :
         {"target", "propose", "simulate", "infer", "baseline", "evaluate", "diagnose"}) {
      const auto is_quick = [&](const Artefact& a) {
        const bool has_methods = stage != "target" && stage != "baseline";
        return a.stage == stage && (!has_methods || a.label.find("ABC") != std::string::npos);
      };
      const auto found = std::ranges::find_if(all, is_quick);
      if (found == all.end()) throw InputError("no artefact of " + stage);
      chosen.push_back(*found);
    }
    return chosen;
  }

  static std::string content(const Artefact& artefact) {
    return std::filesystem::exists(artefact.path) ? content_digest(artefact.path) : "";
  }

  // One run in which the n-th call fails, and one after it. False: it has no such call.
  static bool fail(const Artefact& artefact, const std::string& call, int error, int n,
                   Fates& fates) {
    const std::filesystem::path note = folder_->path() / "note";
    const std::string expected = content(artefact);
    std::filesystem::remove(note);
    std::filesystem::remove_all(artefact.path);
    if (artefact.stage == "simulate") std::filesystem::remove_all(artefact.stem());
    const Outcome outcome = [&] {
      FailingCall failing(call, error);
      failing.set("NPDR_FAIL_AT", std::to_string(n));
      failing.set("NPDR_FAIL_UNDER", folder_->path());
      failing.set("NPDR_FAIL_IN", artefact.program());
      failing.set("NPDR_FAIL_NOTE", note);
      const Program program(folder_->path(), FaultFolder::making(artefact));
      if (!program.ends_within(60.0)) program.send(SIGKILL);
      return program.wait();
    }();
    const bool is_made = outcome.status == 0;
    if (is_made && !std::filesystem::exists(note)) return false;
    const bool is_same = !is_made || content(artefact) == expected;
    if (!is_made) {
      const Outcome again = run(folder_->path(), FaultFolder::making(artefact));
      EXPECT_EQ(again.status, 0) << again.err;
    }
    const bool is_error = outcome.status == 1 || outcome.status == 2;
    const bool has_name = says_where(outcome.err);
    const bool is_misled = outcome.err.find("remove it") != std::string::npos;
    ++fates.failures;
    fates.unharmed += is_made ? 1 : 0;
    fates.reported += is_error && has_name ? 1 : 0;
    fates.killed += outcome.status > 128 ? 1 : 0;
    fates.nameless += outcome.status <= 128 && !is_made && !(is_error && has_name) ? 1 : 0;
    fates.misled += is_misled ? 1 : 0;
    fates.different += is_same && content(artefact) == expected ? 0 : 1;
    if (outcome.status > 128 || is_misled || (!is_made && !has_name)) {
      fmt::print("{} {} of {}, error {}: status {}: {}", call, n, artefact.program(), error,
                 outcome.status, outcome.err);
    }
    return true;
  }
};

TEST_P(EachCall, ThatFailsIsReportedOrDoesNoHarm) {
  fmt::print("{}\n", Fates::title());
  const std::vector<Artefact> artefacts = quickest();
  Fates all;
  for (const int error : GetParam().errors) {
    Fates fates;
    for (const Artefact& artefact : artefacts) {
      for (int n = 1; fail(artefact, GetParam().call, error, n, fates);) n = next(n);
    }
    const std::string name = error == 0 ? "half" : strerrorname_np(error);
    fmt::print("{}\n", fates.row(GetParam().call + " " + name));
    all += fates;
  }
  EXPECT_EQ(all.bad(), 0);
  expect_same_results(*folder_);
}

INSTANTIATE_TEST_SUITE_P(All, EachCall, ::testing::ValuesIn(kCases),
                         [](const auto& of) { return of.param.call; });

}  // namespace
}  // namespace npdr::pipeline
