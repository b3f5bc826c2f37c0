#include "store/csv.h"
#include "report/table.h"

namespace palpate::report {

Table read_csv(const std::filesystem::path& path) {
  store::CsvTable file = store::read_csv(path.string());
  return {std::move(file.headers), std::move(file.rows), path.string()};
}

}  // namespace palpate::report
