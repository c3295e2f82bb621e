// Workers that do what they shouldn't, spoken to as the pipeline does. They are shell scripts
// around a program that speaks the protocol, so that nothing has to be installed.
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/sources/external_simulator.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

// States (a + t, seed) of row a at step t, for rows without BAD; needs nothing but Python.
constexpr const char* kWorker = R"py(
import json, os, struct, sys, time

bad, what = float(os.environ.get("BAD", -1)), os.environ.get("WHAT", "")
open("starts", "a").write("start\n")
requests, replies = sys.stdin.buffer, sys.stdout.buffer
sizes = {"<f8": ("d", 8), "<u4": ("I", 4), "<i8": ("q", 8)}
while True:
    line = requests.readline()
    if not line:
        break
    header, arrays = json.loads(line), {}
    if header["request"] == "hello":
        replies.write(b'{"npdr_worker": 1, "reply": "hello"}\n')
        replies.flush()
        continue
    for a in header["arrays"]:
        count = 1
        for n in a["shape"]:
            count *= n
        code, size = sizes[a["type"]]
        arrays[a["name"]] = struct.unpack("<%d%s" % (count, code), requests.read(count * size))
    open("calls", "a").write("%d %d\n" % (header["first_row"], len(arrays["theta"])))
    rows, steps = len(arrays["theta"]), sum(arrays["steps"])
    status, states = bytearray(rows), []
    for i, a in enumerate(arrays["theta"]):
        if a == bad:
            if what == "dies": os._exit(3)
            if what == "orphans":
                if os.fork() == 0:
                    time.sleep(1000)
                os._exit(3)
            if what == "hangs": time.sleep(1000)
            if what == "error":
                replies.write(b'{"npdr_worker": 1, "reply": "error", "message": "boom"}\n')
                break
            if what == "prints": print("hello", flush=True)
            if what == "nests":
                replies.write(b'{"npdr_worker": 1, "reply": ' + b"[" * 200000 + b"]" * 200000 + b"}\n")
                break
            if what == "half":
                replies.write(b'{"npdr_worker": 1, "reply": "states", "shape": [%d, %d, 2]}\nxyz' % (rows, steps))
                replies.flush()
                os._exit(0)
            if what == "shape":
                replies.write(b'{"npdr_worker": 1, "reply": "states", "shape": [1, 2, 3]}\n')
                break
            if what == "status": status[i] = 4
            if what == "nonsense": status[i] = 99
            if what == "more": sys.stderr.write("rows to spare\n")
        for t in range(steps):
            states += [a + t if not (a == bad and what == "nan") else float("nan"),
                       arrays["seeds"][i] % 1000]
    else:
        reply = {"npdr_worker": 1, "reply": "states", "shape": [rows, steps, 2]}
        if any(status): reply["message"] = "out of fuel"
        replies.write(json.dumps(reply).encode() + b"\n")
        replies.write(struct.pack("<%dd" % len(states), *states) + bytes(status))
    replies.flush()
    if what == "twice" and bad in arrays["theta"]:
        time.sleep(0.05)
        replies.write(json.dumps(reply).encode() + b"\n")
        replies.write(struct.pack("<%dd" % len(states), *states) + bytes(status))
        replies.flush()
        open("second", "a").close()
)py";

class Workers : public ::testing::Test {
 protected:
  Workers() {
    folder_.file("worker.py", kWorker);
    study_.prior = {{"a", "1", inference::Marginal::Kind::uniform, 0.0, 100.0}};
    study_.external.folder = folder_.path();
    study_.external.states = {"x [m]", "y"};
    study_.external.start_time = 20.0;
    study_.external.retries = 0;
  }

  ExternalSimulator simulator(const std::string& what, const std::string& bad) {
    return simulator_of("WHAT=" + what + " BAD=" + bad + " exec python3 worker.py");
  }
  ExternalSimulator simulator_of(const std::string& worker) {
    study_.external.worker = worker;
    Target target;
    target.dt = 0.5;
    target.state_channels = {{"x", "m"}, {"y", "1"}};
    target.rollouts = {{"0", RowMatrix::Zero(5, 2), RowMatrix(4, 0)}};
    return {{study_.external, simulator_info(study_), sim::cut(target, 0), 1, 1}, folder_ / "log"};
  }

  // Rows a = 0, 1, ..., n - 1, one of which does `what`.
  sim::Trajectories run(Index n, const std::string& what, const std::string& bad = "5") {
    std::filesystem::remove(folder_ / "starts");
    std::filesystem::remove(folder_ / "calls");
    RowMatrix theta(n, 1);
    for (Index i = 0; i < n; ++i) theta(i, 0) = static_cast<double>(i);
    return simulator(what, bad).simulate(theta, {7, "test", 1, 0, 0});
  }

  Index lines_of(const std::string& name) const {
    const std::string text = text_of(folder_ / name);
    return std::ranges::count(text, '\n');
  }

  // All rows but number 5 have the values of a worker that does nothing wrong.
  void expect_only_five_is(const sim::Trajectories& x, RolloutStatus status) {
    for (Index i = 0; i < x.num_rows; ++i) {
      EXPECT_EQ(x.status[static_cast<std::size_t>(i)], i == 5 ? status : RolloutStatus::ok) << i;
      if (i == 5) {
        EXPECT_TRUE(std::isnan(x.row(i)[0]));
      } else {
        EXPECT_EQ(x.rollout(i, 0)(3, 0), static_cast<float>(i + 3));
      }
    }
    const sim::Trajectories whole = run(x.num_rows, "nothing");
    for (Index i = 0; i < x.num_rows; ++i) {
      if (i == 5) continue;
      EXPECT_TRUE(std::ranges::equal(x.row(i), whole.row(i))) << i;
    }
  }

  TempFolder folder_;
  Study study_;
};

TEST_F(Workers, AreStartedOnceAndKept) {
  ExternalSimulator simulator = Workers::simulator("nothing", "-1");
  for (int i = 0; i < 3; ++i) {
    const sim::Trajectories x =
        simulator.simulate(RowMatrix::Constant(4, 1, 2.0), {1, "test", 0, 0, 0});
    EXPECT_EQ(x.num_steps, 4);
    EXPECT_EQ(x.rollout(2, 0)(1, 0), 3.0f);
    EXPECT_NE(x.rollout(2, 0)(1, 1), x.rollout(3, 0)(1, 1)) << "each row has a seed of its own";
  }
  EXPECT_EQ(lines_of("starts"), 1);
  EXPECT_EQ(lines_of("calls"), 3);
}

TEST_F(Workers, OnlyTheCulpritOfAFailureIsLost) {
  for (const auto& [what, status] : {std::pair("dies", RolloutStatus::crashed),
                                     {"half", RolloutStatus::crashed},
                                     {"prints", RolloutStatus::bad_output},
                                     {"shape", RolloutStatus::bad_output},
                                     {"nests", RolloutStatus::bad_output},
                                     {"nan", RolloutStatus::diverged}}) {
    SCOPED_TRACE(what);
    expect_only_five_is(run(12, what), status);
  }
}

// It holds the pipe open: that nobody answers is seen all the same, long before the time limit.
TEST_F(Workers, AChildOfAWorkerThatHasDiedIsNotWaitedFor) {
  study_.external.time_limit = 3600.0;
  study_.external.start_time = 3600.0;
  expect_only_five_is(run(6, "orphans"), RolloutStatus::crashed);
}

TEST_F(Workers, OnlyTheCulpritOfAnErrorIsLost) {
  expect_only_five_is(run(12, "error"), RolloutStatus::crashed);
  EXPECT_EQ(lines_of("starts"), 1) << "an error is a reply: the worker goes on";
}

TEST_F(Workers, OnlyTheCulpritOfAHangIsLost) {
  study_.external.time_limit = 3.0;
  study_.external.start_time = 2.0;
  expect_only_five_is(run(6, "hangs"), RolloutStatus::timed_out);
}

// A reply to nothing isn't taken for that to the next request, whose rows it would shift.
TEST_F(Workers, AReplyTooManyIsNoneToTheNextRequest) {
  ExternalSimulator simulator = Workers::simulator("twice", "5");
  const auto value = [&](double a) {
    return simulator.simulate(RowMatrix::Constant(1, 1, a), {1, "test", 0, 0, 0})
        .rollout(0, 0)(0, 0);
  };
  EXPECT_EQ(value(5.0), 5.0f);
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "second"); ++i) usleep(10'000);
  EXPECT_TRUE(std::isnan(value(6.0))) << "without retries";
  EXPECT_TRUE(has(simulator.last_failure(), " before it was asked; each request has one reply"));
  EXPECT_EQ(value(7.0), 7.0f);
  EXPECT_EQ(lines_of("starts"), 2);
}

TEST_F(Workers, RowsThatFailOnTheirOwnNeedNoFurtherRequest) {
  expect_only_five_is(run(12, "status"), RolloutStatus::crashed);
  run(12, "status");
  EXPECT_EQ(lines_of("calls"), 1);
  run(12, "nonsense");
  EXPECT_EQ(lines_of("calls"), 1);
}

TEST_F(Workers, ARowThatDivergesSaysWhichNumberIsNone) {
  ExternalSimulator simulator = Workers::simulator("nan", "1");
  simulator.simulate(RowMatrix::Ones(2, 1), {1, "test", 0, 0, 0});
  EXPECT_EQ(simulator.lost_number(), "row 0 has nan in 'x', step 1 of rollout 1");
}

TEST_F(Workers, AWorkerThatCantBeRunIsAnErrorAtOnce) {
  EXPECT_TRUE(
      has(message_of<Error>([&] {
            simulator_of("./no-such-program").simulate(RowMatrix::Ones(2, 1), {1, "test", 0, 0, 0});
          }),
          "simulator.worker = './no-such-program' can't be run"));
}

TEST_F(Workers, AWorkerThatFailsForEachRowIsAnErrorWithItsWords) {
  const std::string message = message_of<Error>([&] {
    simulator("error", "1").simulate(RowMatrix::Ones(40, 1), {1, "test", 0, 0, 0});
  });
  EXPECT_TRUE(has(message, {"failed for each of", "boom"}));
}

TEST_F(Workers, RowsOutsideOfTheParametersLimitsAreNotAsked) {
  study_.external.parameters = {{.name = "a", .nominal = 1.0, .lower = 2.5}};
  const sim::Trajectories x = run(5, "nothing");
  EXPECT_EQ(text_of(folder_ / "calls"), "3 2\n");
  EXPECT_EQ(x.status[2], RolloutStatus::out_of_limits);
  EXPECT_EQ(x.status[3], RolloutStatus::ok);
  EXPECT_EQ(x.rollout(4, 0)(0, 0), 4.0f);
  study_.external.parameters.clear();
  EXPECT_TRUE(std::ranges::equal(run(5, "nothing").row(4), x.row(4))) << "seeds belong to rows";
}

}  // namespace
}  // namespace npdr::pipeline
