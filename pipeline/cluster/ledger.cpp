#include "pipeline/cluster/ledger.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

std::filesystem::path ledger_of(const Plan& plan) { return jobs_folder(plan) / "submitted.jsonl"; }

std::filesystem::path lock_of(const Plan& plan) {
  make_folder(jobs_folder(plan));
  return jobs_folder(plan) / ".lock";
}

Json to_json(const LedgerEntry& entry) {
  return {{"job", entry.job},
          {"tag", entry.tag.text()},
          {"tasks", entry.tasks},
          {"script", entry.script.string()},
          {"logs", entry.logs.string()},
          {"stem", entry.stem},
          {"submitted", entry.submitted}};
}

LedgerEntry entry_of(const Json& json) {
  const auto tag = parse_tag(json.at("tag").get<std::string>());
  if (!tag) throw InputError("not a tag");
  return {json.at("job").get<std::string>(),          *tag,
          json.at("tasks").get<std::vector<Index>>(), json.at("script").get<std::string>(),
          json.at("logs").get<std::string>(),         json.at("stem").get<std::string>(),
          json.at("submitted").get<std::string>()};
}

}  // namespace

std::filesystem::path jobs_folder(const Plan& plan) {
  return plan.work.study(plan.study.name) / "jobs";
}

SubmissionLock::SubmissionLock(const Plan& plan)
    : file_(lock_of(plan), O_RDWR | O_CREAT | O_NOFOLLOW) {
  if (!file_.is_open()) throw_file_error(lock_of(plan), "be written", errno);
  constexpr int patience = 600;
  constexpr useconds_t pause = 100'000;  // [us]
  for (int i = 0; i < patience; ++i) {
    if (flock(file_.value(), LOCK_EX | LOCK_NB) == 0) return;
    if (errno != EWOULDBLOCK && errno != EINTR) return;  // there are no locks here
    usleep(pause);
  }
  throw Error(lock_of(plan).string() + ": somebody else submits this study; try again later");
}

// One write, as a rule: lines of two programs don't mix.
void append_to_ledger(const Plan& plan, const LedgerEntry& entry) {
  const std::filesystem::path path = ledger_of(plan);
  make_folder(path.parent_path());
  // Paths needn't be UTF-8; JSON must.
  const std::string line =
      to_json(entry).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const OpenFile file(path, O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW);
  if (!file.is_open() || !file.write(line) || fsync(file.value()) != 0) {
    throw Error(fmt::format("{}, so job {} isn't in the ledger",
                            file_error_text(path, "be written", errno), entry.job));
  }
}

std::vector<LedgerEntry> read_ledger(const Plan& plan) {
  std::vector<LedgerEntry> entries;
  std::ifstream file(ledger_of(plan));
  for (std::string line; std::getline(file, line);) {
    try {
      entries.push_back(entry_of(Json::parse(line)));
    } catch (const std::exception&) {
      continue;
    }
  }
  return entries;
}

}  // namespace npdr::pipeline
