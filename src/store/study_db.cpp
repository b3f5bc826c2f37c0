#include "store/study_db.h"

#include <sqlite3.h>

#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::store {
namespace {

constexpr int kBusyMs = 20000;   ///< Another program may be reading.
constexpr int kTextColumns = 9;  ///< Columns before the numbers: key ... reason.

/// Prepared statement; parameter indices from 1, column indices from 0, as in SQLite.
class Statement {
 public:
  Statement(sqlite3* db, const std::string& path, const std::string& sql) : db_(db), path_(path) {
    check(sqlite3_prepare_v2(db, sql.c_str(), -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void bind(int i, const std::string& text) {
    check(sqlite3_bind_text(statement_, i, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  }
  void bind(int i, double value) {
    check(std::isnan(value) ? sqlite3_bind_null(statement_, i) : sqlite3_bind_double(statement_, i, value));
  }
  void bind(int i, int value) { check(sqlite3_bind_int(statement_, i, value)); }
  void bind_blob(int i, const std::string& bytes) {
    check(sqlite3_bind_blob64(statement_, i, bytes.data(), bytes.size(), SQLITE_TRANSIENT));
  }
  /// Advances; returns whether one more row is available.
  bool step() {
    const int outcome = sqlite3_step(statement_);
    if (outcome != SQLITE_ROW && outcome != SQLITE_DONE) check(outcome);
    return outcome == SQLITE_ROW;
  }
  std::string text(int i) const {
    const void* bytes = sqlite3_column_blob(statement_, i);
    return bytes ? std::string(static_cast<const char*>(bytes),
                               static_cast<std::size_t>(sqlite3_column_bytes(statement_, i)))
                 : std::string();
  }
  double number(int i) const {
    return sqlite3_column_type(statement_, i) == SQLITE_NULL ? std::numeric_limits<double>::quiet_NaN()
                                                             : sqlite3_column_double(statement_, i);
  }
  int integer(int i) const { return sqlite3_column_int(statement_, i); }

 private:
  void check(int outcome) {
    if (outcome != SQLITE_OK)
      fail("{}: {} (SQLite: {})", path_, sqlite3_errmsg(db_), sqlite3_errstr(outcome));
  }
  sqlite3* db_;
  const std::string& path_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace

struct StudyDb::Impl {
  Impl(const std::string& file, const std::vector<std::string>& columns) : path(file), numbers(columns) {
    if (sqlite3_open(path.c_str(), &db) != SQLITE_OK) {
      const std::string why = db ? sqlite3_errmsg(db) : "out of memory";
      sqlite3_close(db);
      fail("{}: cannot be opened: {}", path, why);
    }
    sqlite3_busy_timeout(db, kBusyMs);
  }
  ~Impl() { sqlite3_close(db); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void execute(const std::string& sql) {
    char* message = nullptr;
    if (sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &message) == SQLITE_OK) return;
    const std::string why = message ? message : "unknown";
    sqlite3_free(message);
    fail(
        "{}: is not a study database of palpate, or cannot be written ({}); remove it, or choose another "
        "folder with -o DIR",
        path, why);
  }

  /// Returns the number columns that the table has, after the text columns.
  std::vector<std::string> found_columns() {
    Statement columns(db, path, "pragma table_info(run)");
    std::vector<std::string> out;
    for (int i = 0; columns.step(); ++i)
      if (i >= kTextColumns) out.push_back(columns.text(1));
    return out;
  }

  std::string path;
  std::vector<std::string> numbers;
  sqlite3* db = nullptr;
};

StudyDb::StudyDb(const std::string& path, const std::vector<std::string>& numbers)
    : impl_(std::make_unique<Impl>(path, numbers)) {
  std::string columns;
  for (const std::string& name : numbers) columns += ", \"" + name + "\" real";
  impl_->execute(
      "create table if not exists run (key text not null, repeat integer not null, scene text, label text, "
      "integrator text, "
      "setting_name text, setting real, status text, reason text" +
      columns + ", primary key (key, repeat))");
  impl_->execute(
      "create table if not exists artefact (key text primary key, what text, status text, reason text, cpu_s "
      "real, bytes blob)");
  if (impl_->found_columns() != numbers)
    fail("{}: was made by another version of palpate, with other columns; start again with --fresh", path);
}

StudyDb::~StudyDb() = default;

void StudyDb::put(const StudyRun& run) {
  PALPATE_CHECK(run.numbers.size() == impl_->numbers.size(), "{} numbers for {} columns", run.numbers.size(),
                impl_->numbers.size());
  std::string placeholders = "?";
  for (std::size_t i = 1; i < kTextColumns + run.numbers.size(); ++i) placeholders += ",?";
  Statement insert(impl_->db, impl_->path, "insert or replace into run values (" + placeholders + ")");
  insert.bind(1, run.key);
  insert.bind(2, run.repeat);
  insert.bind(3, run.scene);
  insert.bind(4, run.label);
  insert.bind(5, run.integrator);
  insert.bind(6, run.setting_name);
  insert.bind(7, run.setting);
  insert.bind(8, run.status);
  insert.bind(9, run.reason);
  for (std::size_t i = 0; i < run.numbers.size(); ++i)
    insert.bind(kTextColumns + 1 + static_cast<int>(i), run.numbers[i]);
  insert.step();
}

std::vector<StudyRun> StudyDb::runs(const std::string& key) const {
  Statement select(impl_->db, impl_->path, "select * from run where key = ? order by repeat");
  select.bind(1, key);
  std::vector<StudyRun> out;
  while (select.step()) {
    StudyRun run{select.text(0), select.integer(1), select.text(2), select.text(3), select.text(4),
                 select.text(5), select.number(6),  select.text(7), select.text(8), {}};
    for (std::size_t i = 0; i < impl_->numbers.size(); ++i)
      run.numbers.push_back(select.number(kTextColumns + static_cast<int>(i)));
    out.push_back(std::move(run));
  }
  return out;
}

void StudyDb::put(const StudyArtefact& artefact) {
  Statement insert(impl_->db, impl_->path, "insert or replace into artefact values (?,?,?,?,?,?)");
  insert.bind(1, artefact.key);
  insert.bind(2, artefact.what);
  insert.bind(3, artefact.status);
  insert.bind(4, artefact.reason);
  insert.bind(5, artefact.cpu_s);
  insert.bind_blob(6, artefact.bytes);
  insert.step();
}

std::optional<StudyArtefact> StudyDb::artefact(const std::string& key) const {
  Statement select(impl_->db, impl_->path, "select * from artefact where key = ?");
  select.bind(1, key);
  if (!select.step()) return std::nullopt;
  return StudyArtefact{select.text(0), select.text(1),   select.text(2),
                       select.text(3), select.number(4), select.text(5)};
}

long StudyDb::run_count() const {
  Statement count(impl_->db, impl_->path, "select count(*) from run");
  count.step();
  return count.integer(0);
}

}  // namespace palpate::store
