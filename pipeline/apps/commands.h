/// The commands of `npdr`. Each adds itself to the command line; when it is called, it stores the
/// exit status in `result`.
#pragma once

namespace CLI {
class App;
}

namespace npdr::pipeline {

void add_run_command(CLI::App& app, int& result);
void add_submit_command(CLI::App& app, int& result);
void add_cancel_command(CLI::App& app, int& result);
void add_tasks_command(CLI::App& app, int& result);
void add_task_command(CLI::App& app, int& result);
void add_status_command(CLI::App& app, int& result);
void add_explain_command(CLI::App& app, int& result);
void add_validate_command(CLI::App& app, int& result);
void add_new_command(CLI::App& app, int& result);
void add_list_command(CLI::App& app, int& result);
void add_open_command(CLI::App& app, int& result);
void add_import_command(CLI::App& app, int& result);
void add_inspect_command(CLI::App& app, int& result);
void add_verify_command(CLI::App& app, int& result);
void add_sample_command(CLI::App& app, int& result);
void add_log_prob_command(CLI::App& app, int& result);
void add_compare_command(CLI::App& app, int& result);
void add_evidence_command(CLI::App& app, int& result);
void add_export_command(CLI::App& app, int& result);

/// Those that tell of all others: help, man, completion. Come last.
void add_help_commands(CLI::App& app, int& result);

}  // namespace npdr::pipeline
