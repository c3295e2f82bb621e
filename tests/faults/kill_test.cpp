#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tests/faults/fault_study.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::duration;

double seconds_since(Clock::time_point start) {
  return duration<double>(Clock::now() - start).count();
}

// Kills of each stage; more with the environment variable NPDR_FAULT_KILLS.
int num_kills() {
  const char* text = std::getenv("NPDR_FAULT_KILLS");
  return text == nullptr ? 3 : std::max(1, std::atoi(text));
}

// A row of the table that is printed.
struct Tally {
  int kills = 0;
  int running = 0;       // hit while the program ran
  int writing = 0;       // of these, with an unfinished file
  int pieces = 0;        // artefacts and shards that were complete at the instant
  int pieces_lost = 0;   // of these, made again or changed afterward
  double seconds = 0.0;  // that killed programs had run: what is done again takes no longer

  std::string row(const std::string& name) const {
    return fmt::format("| {:<28} | {:5} | {:12} | {:15} | {:8} | {:4} | {:13.2f} |", name, kills,
                       running, writing, pieces, pieces_lost, seconds);
  }
  static std::string title() {
    return fmt::format("| {:<28} | {:5} | {:12} | {:15} | {:8} | {:4} | {:13} |\n|{}|", "killed",
                       "kills", "while it ran", "unfinished file", "complete", "lost", "had run, s",
                       ":--|--:|--:|--:|--:|--:|--:");
  }
};

// The complete files below a folder, and what tells them from files made again.
using Pieces = std::map<std::string, std::pair<fs::file_time_type, ino_t>>;

ino_t inode_of(const fs::path& path) {
  struct stat status = {};
  stat(path.c_str(), &status);
  return status.st_ino;
}

Pieces complete_pieces(const fs::path& cache) {
  Pieces found;
  for (const auto& entry : fs::recursive_directory_iterator(cache)) {
    const std::string name = entry.path().lexically_relative(cache);
    if (entry.path().extension() != ".h5" || name.ends_with(".checkpoint.h5")) continue;
    found[name] = {entry.last_write_time(), inode_of(entry.path())};
  }
  return found;
}

class Kills : public Faults {
 protected:
  // Removes an artefact with all that belongs to it, as if it had never been made.
  static void forget(const Artefact& artefact) {
    fs::remove_all(artefact.path);
    if (artefact.stage == "simulate") fs::remove_all(artefact.stem());
    fs::remove_all(artefact.stem().string() + ".checkpoint.h5");
  }

  static double seconds_to_make(const Artefact& artefact) {
    forget(artefact);
    const auto start = Clock::now();
    with_status(0, make(artefact));
    return seconds_since(start);
  }

  static Outcome kill_after(const Program& program, double seconds) {
    program.ends_within(seconds);
    program.send_to_group(SIGKILL);
    return program.wait();
  }

  static void count(const Outcome& outcome, double seconds, const Pieces& before, Tally& tally) {
    ++tally.kills;
    const Pieces now = complete_pieces(folder_->cache());
    tally.pieces += static_cast<int>(now.size() - before.size());
    if (outcome.status != 128 + SIGKILL) return;
    ++tally.running;
    if (!temporaries(folder_->work()).empty()) ++tally.writing;
    tally.seconds += seconds;
  }

  static int num_lost(const Pieces& before) {
    const Pieces now = complete_pieces(folder_->cache());
    int lost = 0;
    for (const auto& [name, piece] : before) {
      lost += now.contains(name) && now.at(name) == piece ? 0 : 1;
    }
    return lost;
  }

  static std::mt19937 random_;
};

std::mt19937 Kills::random_(1);

// A random instant in `seconds`.
double instant(std::mt19937& random, double seconds) {
  return seconds * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
}

// Every executable of a stage is killed while it makes one artefact, at instants spread over the
// time that this takes; making it again gives the same bits.
TEST_F(Kills, EveryStageGoesOnAfterKillMinus9) {
  fmt::print("{}\n", Tally::title());
  int hits = 0;
  for (const std::string stage : {"target", "held_out", "propose", "simulate", "infer", "baseline",
                                  "evaluate", "diagnose", "report"}) {
    const std::vector<Artefact> artefacts = folder_->artefacts_of(stage);
    Tally tally;
    double whole = 0.05;  // what it takes undisturbed, of the last one
    for (int k = 0; k < num_kills(); ++k) {
      const Artefact& artefact = artefacts[static_cast<std::size_t>(k) % artefacts.size()];
      const auto words = FaultFolder::making(artefact);
      if (static_cast<std::size_t>(k) < artefacts.size()) whole = seconds_to_make(artefact);
      forget(artefact);
      const Pieces before = complete_pieces(folder_->cache());
      const double seconds = instant(random_, whole);
      count(kill_after(Program(folder_->path(), words), seconds), seconds, before, tally);
      const Pieces kept = complete_pieces(folder_->cache());
      with_status(0, make(artefact));
      tally.pieces_lost += num_lost(kept);
    }
    fmt::print("{}\n", tally.row("npdr-" + stage));
    EXPECT_EQ(tally.pieces_lost, 0) << stage;
    hits += tally.running;
  }
  // About three quarters of the instants hit, on a busy machine: fewer than a quarter of 27 do in
  // one of 10^7 runs.
  EXPECT_GE(4 * hits, 9 * num_kills());
  expect_same_results();
}

// A training that was stopped at a checkpoint is killed after it has gone on from there.
TEST_F(Kills, ATrainingGoesOnFromItsCheckpointAfterKillMinus9) {
  Tally tally;
  for (const Artefact& artefact : folder_->artefacts_of("infer")) {
    if (artefact.label.find("ABC") != std::string::npos) continue;
    const auto words = FaultFolder::making(artefact);
    const double whole = seconds_to_make(artefact);
    forget(artefact);
    const Program stopped(folder_->path(), words);
    EXPECT_TRUE(begins_to_make(stopped, folder_->cache()));
    stopped.send(SIGTERM);
    EXPECT_EQ(stopped.wait().status, 75);
    const Pieces before = complete_pieces(folder_->cache());
    const double seconds = instant(random_, whole);
    count(kill_after(Program(folder_->path(), words), seconds), seconds, before, tally);
    with_status(0, make(artefact));
    EXPECT_FALSE(fs::exists(artefact.stem().string() + ".checkpoint.h5"));
  }
  fmt::print("{}\n", tally.row("npdr-infer, resumed"));
  expect_same_results();
}

// Who dies of a run.
enum class Victim { scheduler, all, child };

std::string name_of(Victim victim) {
  switch (victim) {
    case Victim::scheduler:
      return "npdr run, without children";
    case Victim::all:
      return "npdr run with its children";
    case Victim::child:
      return "a child of npdr run";
  }
  return "";
}

void strike(const Program& program, Victim victim) {
  const std::vector<pid_t> children = program.children();
  if (victim != Victim::child) program.send(SIGKILL);
  if (victim == Victim::scheduler) return;
  for (const pid_t child : children) {
    kill(child, SIGKILL);
    if (victim == Victim::child) return;
  }
}

// Runs of a new work folder are killed one after the other, and one may come to its end.
class KilledRuns : public Kills {
 protected:
  static Tally kill_runs(Victim victim) {
    Tally tally;
    for (int k = 0; k < num_kills(); ++k) {
      // A run that has lost a child goes on: there is work to do again.
      if (victim == Victim::child) fs::remove_all(folder_->cache() / "infer");
      const Pieces before = complete_pieces(folder_->cache());
      const auto start = Clock::now();
      const Program program(folder_->path(), FaultFolder::npdr_words({"run"}));
      comes_true([&] { return program.has_ended() || !program.children().empty(); });
      // The first is hit at once, however fast the machine is.
      if (k > 0) program.ends_within(instant(random_, 0.5));
      const double seconds = seconds_since(start);
      const bool ran = !program.children().empty();
      strike(program, victim);
      const int status = program.wait().status;
      // Without one child it finishes what doesn't depend on it.
      if (victim == Victim::child && ran) {
        EXPECT_TRUE(status == 0 || status == 1) << status;
      }
      ++tally.kills;
      tally.running += ran ? 1 : 0;
      tally.writing += ran && !temporaries(folder_->work()).empty() ? 1 : 0;
      tally.seconds += seconds;
      tally.pieces_lost += num_lost(before);
      tally.pieces = static_cast<int>(complete_pieces(folder_->cache()).size());
    }
    return tally;
  }
};

TEST_F(KilledRuns, GoOnWithTheSameBits) {
  fmt::print("{}\n", Tally::title());
  for (const Victim victim : {Victim::scheduler, Victim::all, Victim::child}) {
    fs::remove_all(folder_->work());
    fs::create_directories(folder_->cache());
    const Tally tally = kill_runs(victim);
    // The first may meet children at work whose parent was killed: they end by themselves.
    folder_->npdr(0, {"run"});
    fmt::print("{}\n", tally.row(name_of(victim)));
    expect_to_go_on();
    EXPECT_EQ(tally.pieces_lost, 0);
    EXPECT_GE(tally.running, 1) << "kills that hit nothing show nothing";
  }
}

// Two runs of one folder, of which one or both are killed, while somebody asks how they stand. One
// that is left ends with all that is needed, and all begins anew.
class KilledPairs : public KilledRuns {
 protected:
  // Returns whether the second was left to end.
  static bool kill_pair(int cycle, Tally& tally) {
    const auto words = FaultFolder::npdr_words({"run", "--jobs", "1"});
    const auto first = start(words, 0), second = start(words, 1);
    const auto asked = cycle % 4 < 2 ? std::vector<std::string>{"status", "--check"}
                                     : std::vector<std::string>{"submit", "--dry-run"};
    const auto somebody = start(FaultFolder::npdr_words(asked), 2);
    first->ends_within(instant(random_, 1.5));
    tally.running += first->has_ended() ? 0 : 1;
    strike(*first, cycle % 3 == 0 ? Victim::scheduler : Victim::all);
    const bool is_left = cycle % 2 == 1;
    if (!is_left) strike(*second, Victim::all);
    ++tally.kills;
    with_status(0, somebody->wait());
    first->wait();
    const Outcome outcome = second->wait();
    if (is_left) with_status(0, outcome);
    return is_left;
  }
};

TEST_F(KilledPairs, GoOnWithTheSameBitsWhileSomebodyLooks) {
  fs::remove_all(folder_->work());
  Tally tally;
  for (int cycle = 0; cycle < num_kills(); ++cycle) {
    if (!kill_pair(cycle, tally)) continue;
    EXPECT_EQ(differences(results(*folder_), *expected_), kNone);
    std::error_code ignored;  // children of the one that was killed may still write
    fs::remove_all(folder_->cache(), ignored);
  }
  folder_->npdr(0, {"run"});
  fmt::print("{} pairs, of which {} were killed at work\n", tally.kills, tally.running);
  expect_to_go_on();
  EXPECT_GE(tally.running, 1) << "kills that hit nothing show nothing";
}

}  // namespace
}  // namespace npdr::pipeline
