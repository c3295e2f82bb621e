#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <list>
#include <map>

#include "core/error.h"
#include "core/text.h"
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
    while (!variables_.empty()) variables_.pop_back();  // the last one first
  }

  void set(const std::string& variable, const std::string& value) {
    variables_.emplace_back(variable, value);
  }

 private:
  std::list<EnvironmentVariable> variables_;
};

class FailingCalls : public Faults {
 protected:
  // A posterior that is made of simulations.
  static Artefact posterior() {
    std::vector<Artefact> all = folder_->artefacts_of("infer");
    return *std::ranges::find_if(all, [](const Artefact& a) { return has(a.label, "MoG"); });
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
      const Outcome failed = with_status(1, make(reader));
      EXPECT_FALSE(has(failed.err, "remove")) << call << " " << error;
      EXPECT_TRUE(has(failed.err, ".h5"));
      failing.set("NPDR_FAIL_UNDER", ".cache");
      EXPECT_FALSE(has(folder_->npdr({"status", "--check"}).out, "remove"));
    }
  }
  expect_to_go_on();
}

TEST_F(FailingCalls, AReadThatIsCutShortIsGoneOnWith) {
  const Artefact reader = posterior();
  std::filesystem::remove(reader.path);
  {
    FailingCall failing("pread", 0);
    failing.set("NPDR_FAIL_UNDER", ".cache");
    with_status(0, make(reader));
    EXPECT_FALSE(has(folder_->npdr({"status", "--check"}).out, "remove"));
  }
  expect_same_results();
}

TEST_F(FailingCalls, AFileThatCannotBeClosedIsNamed) {
  const Artefact reader = posterior();
  std::filesystem::remove(reader.path);
  {
    FailingCall failing("close", EIO);
    failing.set("NPDR_FAIL_UNDER", ".cache/simulate");
    EXPECT_TRUE(has(with_status(1, make(reader)).err, ".h5: HDF5 couldn't close this file"));
  }
  expect_to_go_on();
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
  with_status(0, run(folder.path(), {"npdr-propose", "s.toml"}));
  FailingCall failing("signalfd", ENFILE);
  failing.set("NPDR_FAIL_NOTE", folder / "note");
  const Program program(folder.path(), {"npdr-simulate", "s.toml"});
  EXPECT_TRUE(program.ends_within(20.0));
  with_status(0, program.wait());
  EXPECT_TRUE(text_of(folder / "note").starts_with("signalfd")) << "the call is made";
}

// A call and the ways in which it fails; 0: it does half of what it is asked for.
struct CallAndErrors {
  std::string call;
  std::vector<int> errors;
  friend void PrintTo(const CallAndErrors& c, std::ostream* stream) { *stream << c.call; }
};

const std::vector<CallAndErrors> kCases = {
    {"open", {EMFILE, EINTR}},  {"read", {EIO, EINTR, 0}},
    {"pread", {EIO, EINTR, 0}}, {"write", {ENOSPC, EINTR, 0}},
    {"pwrite", {ENOSPC, 0}},    {"fsync", {EIO}},
    {"rename", {EIO}},          {"close", {EIO}}};

// What became of programs in which one call failed, and how often.
const std::vector<std::string> kFates = {
    "calls",      // that failed
    "unharmed",   // the program went on, to the same bits
    "reported",   // status 1 or 2, with the name of a file
    "killed",     // by a signal, or it hung
    "nameless",   // another status, or no file is named
    "misled",     // somebody was told to remove a good file
    "different",  // other bits, at once or when it is run again
};
using Fates = std::map<std::string, int>;

std::string row_of(const std::string& name, const Fates& fates) {
  std::string row = fmt::format("| {:<22} |", name);
  for (const std::string& fate : kFates) row += fmt::format(" {:9} |", fates.at(fate));
  return row;
}

// Every n-th call of each stage fails: the first, the eighth and so on; all of them with the
// environment variable NPDR_FAULT_CALLS=1.
class EachCall : public Faults, public ::testing::WithParamInterface<CallAndErrors> {
 protected:
  static int next(int n) { return std::getenv("NPDR_FAULT_CALLS") == nullptr ? 8 * n : n + 1; }

  static bool says_where(const std::string& message) {
    return has(message, "runs") || has(message, "faults.toml") || has(message, "recording.h5");
  }

  // Of each of these stages the artefact that is made in the shortest time.
  static std::vector<Artefact> quickest() {
    const std::vector<Artefact> all = folder_->artefacts();
    std::vector<Artefact> chosen;
    for (const std::string stage :
         {"target", "propose", "simulate", "infer", "evaluate", "diagnose"}) {
      const auto found = std::ranges::find_if(all, [&](const Artefact& a) {
        return a.stage == stage && (stage == "target" || has(a.label, "ABC"));
      });
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
    if (!is_made) with_status(0, make(artefact));
    const bool is_error = outcome.status == 1 || outcome.status == 2;
    const bool has_name = says_where(outcome.err);
    const bool is_misled = outcome.err.find("remove it") != std::string::npos;
    ++fates["calls"];
    fates["unharmed"] += is_made ? 1 : 0;
    fates["reported"] += is_error && has_name ? 1 : 0;
    fates["killed"] += outcome.status > 128 ? 1 : 0;
    fates["nameless"] += outcome.status <= 128 && !is_made && !(is_error && has_name) ? 1 : 0;
    fates["misled"] += is_misled ? 1 : 0;
    fates["different"] += is_same && content(artefact) == expected ? 0 : 1;
    if (outcome.status > 128 || is_misled || (!is_made && !has_name)) {
      fmt::print("{} {} of {}, error {}: status {}: {}", call, n, artefact.program(), error,
                 outcome.status, outcome.err);
    }
    return true;
  }
};

TEST_P(EachCall, ThatFailsIsReportedOrDoesNoHarm) {
  fmt::print("| {:<22} | {} |\n", "failing", join(kFates, " | "));
  const std::vector<Artefact> artefacts = quickest();
  for (const int error : GetParam().errors) {
    Fates fates;
    for (const std::string& fate : kFates) fates[fate] = 0;
    for (const Artefact& artefact : artefacts) {
      for (int n = 1; fail(artefact, GetParam().call, error, n, fates);) n = next(n);
    }
    const std::string name = GetParam().call + " " + (error == 0 ? "half" : strerrorname_np(error));
    fmt::print("{}\n", row_of(name, fates));
    for (const char* bad : {"killed", "nameless", "misled", "different"}) {
      EXPECT_EQ(fates[bad], 0) << name << ": " << bad;
    }
  }
  expect_same_results();
}

INSTANTIATE_TEST_SUITE_P(All, EachCall, ::testing::ValuesIn(kCases),
                         [](const auto& of) { return of.param.call; });

}  // namespace
}  // namespace npdr::pipeline
