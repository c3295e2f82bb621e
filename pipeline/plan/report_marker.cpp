#include "pipeline/plan/report_marker.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <ranges>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/process/build_info.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {

namespace {

// Null where there is none, or it can't be read.
nlohmann::ordered_json marker_of(const Node& report) {
  std::ifstream file(report.path);
  return json_in({std::istreambuf_iterator<char>(file), {}}).value_or(nullptr);
}

// Names of files needn't be UTF-8, which JSON must be.
std::string shown_name(const std::filesystem::path& study) {
  return printable_line(study.filename().string());
}

constexpr std::array<std::pair<const char*, std::string Finding::*>, 5> kTexts = {
    {{"check", &Finding::where},
     {"id", &Finding::id},
     {"what", &Finding::what},
     {"evidence", &Finding::evidence},
     {"advice", &Finding::advice}}};

nlohmann::ordered_json json_of(const Findings& reasons) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Finding& reason : reasons) {
    auto& json = all.emplace_back() = {{"severity", name_of(reason.severity)}};
    for (const auto& [key, text] : kTexts) json[key] = reason.*text;
  }
  return all;
}

Findings reasons_of(const nlohmann::ordered_json& all) {
  Findings reasons;
  for (const auto& json : all) {
    const auto severity = value_named<Severity>(json.at("severity").get<std::string>());
    Finding& reason = reasons.emplace_back(Finding{.severity = severity.value_or(Severity::wrong)});
    for (const auto& [key, text] : kTexts) reason.*text = json.at(key);
  }
  return reasons;
}

// What checks of these titles refute: "parameters and error bars".
std::string refuted_by(const std::vector<std::string>& titles) {
  std::vector<std::string> names = {"parameters", "error bars", "predictions"};
  std::erase_if(names, [&](const std::string& name) {
    return std::ranges::none_of(enum_table(Check{}), [&](const CheckTraits& check) {
      return std::ranges::count(titles, check.title) > 0 &&
             check.refutes.find(name) != std::string_view::npos;
    });
  });
  return listed(names);
}

}  // namespace

bool report_is_current(const Plan& plan, const Node& node) {
  if (!std::filesystem::exists(report_path(plan))) return false;
  const auto json = marker_of(node);
  if (!json.is_object() || !json.contains("key") || json["key"] != node.key) return false;
  if (json.value("revision", nlohmann::ordered_json()) != git_revision()) return false;
  const auto files = json.find("files");
  return files != json.end() && std::ranges::all_of(*files, [&](const auto& name) {
           return name.is_string() && std::filesystem::exists(node.path.parent_path() /
                                                              name.template get<std::string>());
         });
}

void mark_report(const Node& node, const std::filesystem::path& study,
                 const std::vector<std::filesystem::path>& files,
                 const std::vector<CheckSummary>& checks) {
  std::vector<std::string> names;
  for (const auto& file : files) {
    names.push_back(file.lexically_relative(node.path.parent_path()).generic_string());
  }
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  for (const CheckSummary& summary : checks) {
    verdicts.push_back({{"method", summary.method},
                        {"num_checks", summary.num_checks},
                        {"failed", summary.failed},
                        {"unknown", summary.unknown},
                        {"unchecked", summary.unchecked},
                        {"reasons", json_of(summary.reasons)}});
  }
  const nlohmann::ordered_json json = {{"key", node.key},
                                       {"revision", git_revision()},
                                       {"study", shown_name(study)},
                                       {"files", names},
                                       {"checks", verdicts},
                                       {"key_document", node.identity.key_document}};
  // In ASCII: titles may hold characters that turn what a terminal shows.
  write_text_file(node.path,
                  json.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

std::vector<CheckSummary> read_check_summaries(const Node& node) {
  std::vector<CheckSummary> summaries;
  const auto marker = marker_of(node);
  // Another run is making the report anew.
  if (marker.is_null() && !std::filesystem::exists(node.path)) return summaries;
  const std::string damaged =
      node.path.string() + ": is damaged; remove it and run the study again";
  try {
    for (const auto& verdict : marker.at("checks")) {
      const auto& count = verdict.at("num_checks");
      if (!count.is_number_unsigned() || count > 1000) throw InputError(damaged);
      summaries.push_back({verdict.at("method"), verdict.at("num_checks"), verdict.at("failed"),
                           verdict.at("unknown"), verdict.at("unchecked"),
                           reasons_of(verdict.at("reasons"))});
    }
  } catch (const nlohmann::ordered_json::exception&) {
    throw InputError(damaged);
  }
  return summaries;
}

std::optional<CheckSummary> reported_checks(const Plan& plan, const std::string& method) try {
  const Node& report = plan.nodes.back();
  const std::map<std::string, std::string> shown =
      marker_of(report).at("key_document").at("inputs");
  const auto is_shown = [&](const auto& input) {
    return std::ranges::count(shown | std::views::values, input.second) > 0;
  };
  if (!std::ranges::all_of(report.identity.inputs, is_shown)) return std::nullopt;
  const std::vector<CheckSummary> all = read_check_summaries(report);
  const auto found = std::ranges::find(all, method, &CheckSummary::method);
  if (found == all.end()) return std::nullopt;
  return *found;
} catch (const std::exception&) {  // hostile, or gone meanwhile
  return std::nullopt;
}

std::string words_of(const CheckSummary& summary) {
  std::string text = summary.method + ": ";
  if (!summary.failed.empty()) {
    text += fmt::format("{} of {} FAIL: {}", summary.failed.size(),
                        counted(summary.num_checks, "check"), join(summary.failed));
  } else if (summary.num_checks == 0) {
    text += "no check looks at the result";
  } else if (summary.unknown.empty()) {
    text += summary.num_checks == 1 ? "its only check passes"
                                    : fmt::format("all {} checks pass", summary.num_checks);
  } else {
    text += fmt::format("{} of {} pass", summary.num_checks - std::ssize(summary.unknown),
                        counted(summary.num_checks, "check"));
  }
  if (!summary.unknown.empty()) text += "; can't tell: " + join(summary.unknown);
  if (!summary.unchecked.empty()) text += "; not checked: " + join(summary.unchecked);
  return text;
}

std::string trust_of(const CheckSummary& summary) {
  if (!summary.failed.empty()) {
    const std::string refuted = refuted_by(summary.failed);
    return refuted.empty() ? "" : fmt::format("Don't trust its {}.", refuted);
  }
  if (!summary.unknown.empty()) {
    return fmt::format("Too little is known to trust its {}.", refuted_by(summary.unknown));
  }
  if (summary.num_checks == 0) return "";
  const bool has_notes = std::ranges::any_of(
      summary.reasons, [](const Finding& reason) { return reason.id != "unchecked"; });
  return fmt::format("Trust its parameters and error bars within this simulator{}.",
                     has_notes ? ", but see the notes" : "");
}

Findings find_replaced_report(const Plan& plan) {
  const Study& study = plan.study;
  const Node& report = plan.nodes.back();
  const auto json = marker_of(report);
  if (!json.is_object() || !json.contains("study") || !json["study"].is_string()) return {};
  const std::string other = json["study"];
  if (other == shown_name(study.places.origin()) || report_is_current(plan, report)) return {};
  return {warning(fmt::format("study.name = '{}' is that of {}, too, whose report {} will be "
                              "replaced: give one of them another name",
                              study.name, printable_line(other), report_path(plan).string()),
                  study.places.of("study.name").str())};
}

std::filesystem::path report_path(const Plan& plan) {
  return plan.work.study(plan.study.name) / "report.html";
}

}  // namespace npdr::pipeline
