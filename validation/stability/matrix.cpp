#include <algorithm>

#include "cell_runner.h"
#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

namespace palpate::stability {
namespace {

bool chosen(const std::string& name, const std::vector<std::string>& requested) {
  return requested.empty() || std::find(requested.begin(), requested.end(), name) != requested.end();
}

void check_names(const std::vector<std::string>& requested, const std::vector<std::string>& known,
                 const char* what) {
  for (const std::string& name : requested)
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail("unknown {} \"{}\"{}", what, name, suggestion(name, known));
}

}  // namespace

StabilityMatrix run(const StabilityOptions& options) {
  const double start = wall_seconds();
  const dynamics::StepperRegistry& registry =
      options.registry ? options.registry() : integrate::stepper_registry();
  const std::vector<Row> rows = all_rows();
  check_names(options.rows, names(rows), "row");
  std::vector<std::string> known = names(registry);
  for (const Column& column : tool_columns()) known.push_back(column.name);
  check_names(options.integrators, known, "integrator");

  std::vector<std::vector<Column>> columns;  // Columns of each row; tasks point into them.
  for (const Row& row : rows) columns.push_back(columns_of(row, registry));
  std::vector<Task> tasks;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Row& row = rows[r];
    if (!chosen(row.name, options.rows) || (row.slow && !options.slow && options.rows.empty())) continue;
    for (const SubCase& one : row.cases) {
      if (options.core && &one != &row.cases[row.core]) continue;
      for (const Column& column : columns[r])
        if (chosen(column.name, options.integrators)) tasks.push_back({&row, &one, &column});
    }
  }
  StabilityMatrix matrix;
  matrix.cells = run_cells(tasks, options, matrix.outcome);
  matrix.wall_s = wall_seconds() - start;
  return matrix;
}

}  // namespace palpate::stability
