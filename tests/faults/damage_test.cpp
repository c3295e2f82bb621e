#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "core/error.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/store/artefact.h"
#include "tests/faults/fault_study.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

std::string flipped(std::string bytes, std::size_t at) {
  bytes[at] = static_cast<char>(~bytes[at]);
  return bytes;
}

// Distance of the bytes that are flipped; 1 with the environment variable NPDR_FAULT_STEP=1: all.
std::size_t flip_step() {
  const char* text = std::getenv("NPDR_FAULT_STEP");
  return text == nullptr ? 397 : static_cast<std::size_t>(std::max(1, std::atoi(text)));
}

// Fates of files in which one byte was wrong.
struct Flips {
  int detected = 0;  // with an InputError that names the file
  int harmless = 0;  // the same content
  int crashed = 0;   // in the HDF5 library
  int wrong = 0;     // another content, without a word

  std::string row(const std::string& name) const {
    return fmt::format("| {:<30} | {:8} | {:8} | {:7} | {:5} |", name, detected, harmless, crashed,
                       wrong);
  }
};

// Where damage is met: the file, the artefact that needs it, and what else has to go.
struct Case {
  std::string name;
  fs::path damaged;
  Artefact reader;
  std::vector<fs::path> removed;  // as the message asks for
};

class Damage : public Faults {
 protected:
  // A file of the cache that takes its place among the others again at the end of the test.
  class Kept {
   public:
    explicit Kept(fs::path path) : path_(std::move(path)), bytes_(text_of(path_)) {}
    ~Kept() { write_bytes(path_, bytes_); }
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;
    const std::string& bytes() const { return bytes_; }

   private:
    fs::path path_;
    std::string bytes_;
  };

  static Artefact artefact(const std::string& stage, const std::string& label = "") {
    for (const Artefact& candidate : folder_->artefacts_of(stage)) {
      if (candidate.label.find(label) != std::string::npos) return candidate;
    }
    ADD_FAILURE() << "no " << stage << " " << label;
    return {};
  }

  // Flips every `step`-th byte of `damaged`. `read` gives the content that is asked for.
  static Flips flip(const fs::path& damaged, std::size_t step,
                    const std::function<std::string()>& read) {
    const Kept kept(damaged);
    const std::string good = read();
    Flips flips;
    for (std::size_t at = 0; at < kept.bytes().size(); at += step) {
      write_bytes(damaged, flipped(kept.bytes(), at));
      const fs::path outcome = folder_->path() / "outcome";
      write_bytes(outcome, "crashed");
      try_in_child([&] {
        std::string said = "wrong";
        try {
          if (read() == good) said = "harmless";
        } catch (const InputError& error) {
          const bool is_named =
              std::string(error.what()).find(damaged.filename()) != std::string::npos;
          said = is_named ? "detected" : "nameless";
        }
        write_bytes(outcome, said);
      });
      const std::string said = text_of(outcome);
      flips.detected += said == "detected";
      flips.harmless += said == "harmless";
      flips.crashed += said == "crashed";
      flips.wrong += said == "wrong" || said == "nameless";
    }
    return flips;
  }

  static void forget(const Artefact& artefact) { fs::remove_all(artefact.path); }

  static std::vector<Case> cases() {
    const Artefact simulation = artefact("simulate", "MAF, seed 1, round 1");
    const fs::path shard = simulation.stem() / "rows-64-128.h5";
    const Artefact posterior = artefact("infer", "MAF, seed 1, round 1");
    const Artefact proposal = artefact("propose", "MAF, seed 1, round 1");
    return {{"shard that is to be joined", shard, simulation, {shard}},
            {"shard of a joined simulation", shard, posterior, {shard, simulation.path}},
            {"simulation", simulation.path, posterior, {simulation.path}},
            {"posterior",
             posterior.path,
             artefact("propose", "MAF, seed 1, round 2"),
             {posterior.path}},
            {"proposal", proposal.path, simulation, {proposal.path}}};
  }

  static void meet(const Case& c, const std::string& bytes) {
    forget(c.reader);
    if (c.name == "proposal") fs::remove_all(c.reader.stem());
    write_bytes(c.damaged, bytes);
    const Outcome failed = folder_->npdr(2, {"run"});
    EXPECT_TRUE(has(failed.err, {c.damaged.filename(), "remove it"})) << c.name;
    EXPECT_TRUE(has(folder_->npdr(1, {"status", "--check"}).out, "damaged, remove it: ")) << c.name;
    for (const fs::path& path : c.removed) {
      EXPECT_TRUE(has(failed.err, path.filename()));
      fs::remove(path);
    }
    expect_to_go_on();
    folder_->npdr(0, {"status", "--check"});
  }
};

// The checksums of HDF5 don't cover all of a file; the seal does.
TEST_F(Damage, NoFlippedByteGoesUnnoticed) {
  fmt::print("| one byte flipped in            | detected | harmless | crashed | wrong |\n");
  const auto simulation = artefact("simulate", "MAF, seed 1, round 1");
  const std::vector<std::pair<std::string, fs::path>> files = {
      {"target", artefact("target").path},
      {"proposal", artefact("propose").path},
      {"shard of a simulation", simulation.stem() / "rows-0-64.h5"},
      {"simulation", simulation.path},
      {"posterior (flow)", artefact("infer", "MAF").path},
      {"posterior (particles)", artefact("infer", "ABC").path},
      {"evaluation", artefact("evaluate").path},
      {"diagnosis", artefact("diagnose").path},
      {"baseline", artefact("baseline").path}};
  for (const auto& [name, path] : files) {
    const ArtefactInfo info = read_artefact_info(path);
    const Flips flips = flip(path, flip_step(), [&, path = path] {
      const h5::File file = open_artefact({path, info.key}, info.schema);
      return content_digest(path);
    });
    fmt::print("{}\n", flips.row(name));
    EXPECT_EQ(flips.harmless + flips.crashed + flips.wrong, 0) << name;
  }
}

// A joined simulation reads its shards' trajectories without looking at their seals: each would be
// read twice. These have the checksums of HDF5.
TEST_F(Damage, NoFlippedByteOfAShardReachesTraining) {
  const auto simulation = artefact("simulate", "MAF, seed 1, round 1");
  const Flips flips =
      flip(simulation.stem() / "rows-64-128.h5", std::max<std::size_t>(1, flip_step() / 4), [&] {
        const auto values = h5::File::open(simulation.path).dataset("trajectories").read<float>();
        return std::string(reinterpret_cast<const char*>(values.data()),
                           values.size() * sizeof(float));
      });
  fmt::print("{}\n", flips.row("shard, read by its simulation"));
  EXPECT_GT(flips.detected, 0);
  EXPECT_EQ(flips.crashed + flips.wrong, 0);
}

TEST_F(Damage, DamageIsNamedAndWhatIsRemovedIsMadeAgain) {
  for (const Case& c : cases()) {
    const std::string good = text_of(c.damaged);
    // Far from the ends lie the values.
    meet(c, flipped(good, good.size() * 2 / 3));
    meet(c, good.substr(0, good.size() * 2 / 3));
  }
}

TEST_F(Damage, ADamagedCheckpointIsNamed) {
  const Artefact posterior = artefact("infer", "MAF, seed 1, round 2");
  const fs::path checkpoint = posterior.stem().string() + ".checkpoint.h5";
  forget(posterior);
  const Program stopped(folder_->path(), FaultFolder::making(posterior));
  EXPECT_TRUE(begins_to_make(stopped, folder_->cache()));
  stopped.send(SIGTERM);
  EXPECT_EQ(stopped.wait().status, 75);
  ASSERT_TRUE(fs::exists(checkpoint));
  const std::string good = text_of(checkpoint);
  for (const std::string& bytes :
       {flipped(good, good.size() / 2), good.substr(0, good.size() / 2), std::string()}) {
    write_bytes(checkpoint, bytes);
    EXPECT_TRUE(has(folder_->npdr(2, {"run"}).err, {checkpoint.filename(), "remove it"}));
    EXPECT_TRUE(has(folder_->npdr({"status"}).out, "damaged, remove it: "));
  }
  fs::remove(checkpoint);
  expect_to_go_on();
}

}  // namespace
}  // namespace npdr::pipeline
