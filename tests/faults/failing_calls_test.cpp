#include <cerrno>
#include <cstdlib>

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

class FailingCalls : public Faults {};

TEST_F(FailingCalls, AFileSystemWithoutLocksNeedsNone) {
  for (const int error : {ENOLCK, EOPNOTSUPP}) {
    std::filesystem::remove_all(folder_->work());
    const FailingCall without_locks("flock", error);
    const Outcome outcome = folder_->npdr({"run"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    expect_same_results(*folder_);
  }
}

// Whatever keeps a good file from being read, nobody is to remove it.
TEST_F(FailingCalls, WhatCannotBeReadJustNowIsNotCalledDamaged) {
  const Artefact reader = folder_->artefacts_of("infer").back();
  const std::filesystem::path cache = folder_->cache();
  for (const std::string call : {"open", "pread"}) {
    for (const int error : {EMFILE, EACCES, EIO, EAGAIN}) {
      std::filesystem::remove(reader.path);
      FailingCall failing(call, error);
      failing.set("NPDR_FAIL_UNDER", cache / "simulate");
      const Outcome failed = run(folder_->path(), FaultFolder::making(reader));
      EXPECT_EQ(failed.status, 1) << call << " " << error << ": " << failed.err;
      EXPECT_EQ(failed.err.find("remove"), std::string::npos) << failed.err;
      EXPECT_NE(failed.err.find(".h5"), std::string::npos) << failed.err;
      failing.set("NPDR_FAIL_UNDER", cache);
      const Outcome status = folder_->npdr({"status", "--check"});
      EXPECT_EQ(status.out.find("remove"), std::string::npos) << status.out;
    }
  }
  EXPECT_EQ(folder_->npdr({"run"}).status, 0);
  expect_same_results(*folder_);
}

TEST_F(FailingCalls, AReadThatIsCutShortIsGoneOnWith) {
  const Artefact reader = folder_->artefacts_of("infer").back();
  std::filesystem::remove(reader.path);
  {
    FailingCall failing("pread", 0);
    failing.set("NPDR_FAIL_UNDER", folder_->cache());
    const Outcome outcome = run(folder_->path(), FaultFolder::making(reader));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(folder_->npdr({"status", "--check"}).out.find("remove"), std::string::npos);
  }
  expect_same_results(*folder_);
}

}  // namespace
}  // namespace npdr::pipeline
