#include "store/result_db.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "palpate/core/error.h"
#include "store/provenance.h"

namespace palpate::store {
namespace {

constexpr int kBusyMs = 20000;  ///< Another program may be reading.

/// Returns the names and values of all columns of text.
std::vector<std::pair<const char*, std::string*>> texts_of(ResultRow& row) {
  std::vector<std::pair<const char*, std::string*>> out = {{"key", &row.key},
                                                           {"kind", &row.kind},
                                                           {"task", &row.task},
                                                           {"status", &row.status},
                                                           {"reason", &row.reason}};
  for (const auto& field : row.machine.fields()) out.push_back(field);
  return out;
}

std::vector<std::pair<const char*, double*>> numbers_of(ResultRow& row) {
  return {{"cpu_s", &row.cpu_s}, {"limit_s", &row.limit_s}};
}

/// Returns `"key" text, "kind" text, ..., "bytes" blob`, or only the names, without quotes.
std::string columns(bool with_types) {
  ResultRow row;
  std::string out;
  const auto add = [&](const std::string& name, const char* type) {
    out += out.empty() ? "" : ", ";
    out += with_types ? '"' + name + "\" " + type : name;
  };
  for (const auto& [name, value] : texts_of(row)) add(name, "text");
  for (const auto& [name, value] : numbers_of(row)) add(name, "real");
  add("bytes", "blob");
  return out;
}

/// Prepared statement; parameter indices from 1, column indices from 0, as in SQLite.
class Query {
 public:
  Query(sqlite3* db, const std::string& path, const std::string& sql) : db_(db), path_(path) {
    check(sqlite3_prepare_v2(db, sql.c_str(), -1, &statement_, nullptr));
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  void bind(int i, const std::string& text) {
    check(sqlite3_bind_text(statement_, i, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  }
  void bind(int i, double value) { check(sqlite3_bind_double(statement_, i, value)); }
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
  double number(int i) const { return sqlite3_column_double(statement_, i); }
  ResultRow row() const {
    ResultRow out;
    int i = 0;
    for (const auto& [name, value] : texts_of(out)) *value = text(i++);
    for (const auto& [name, value] : numbers_of(out)) *value = number(i++);
    out.bytes = text(i);
    return out;
  }

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

Machine Machine::here() {
  char name[256] = {};
  static const std::string host = gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
  static const Provenance made_by = provenance();
  return {host,
          made_by.cpu,
          fmt::format("{}", made_by.cores),
          made_by.system,
          made_by.version,
          made_by.commit,
          provenance().started_utc};
}

struct ResultDb::Impl {
  Impl(const std::string& file, Access access) : path(file) {
    const int create = access == Access::kRead ? 0 : SQLITE_OPEN_CREATE,
              flags = SQLITE_OPEN_READWRITE | create;
    const char* locks = access == Access::kSingle ? "unix-none" : nullptr;
    if (sqlite3_open_v2(path.c_str(), &db, flags, locks) != SQLITE_OK) {
      const std::string why = db ? sqlite3_errmsg(db) : "out of memory";
      sqlite3_close(db);
      fail("{}: cannot be opened: {}", path, why);
    }
    sqlite3_busy_timeout(db, kBusyMs);
  }
  ~Impl() { sqlite3_close(db); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void execute(const std::string& sql) const {
    char* message = nullptr;
    const int code = sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &message);
    if (code == SQLITE_OK) return;
    const std::string why = message ? message : "unknown";
    sqlite3_free(message);
    if (code == SQLITE_FULL) fail("{}: cannot be written: {}", path, std::strerror(ENOSPC));
    fail(
        "{}: is not a database of palpate's results, or cannot be written ({}); remove it, or choose another "
        "folder with -o DIR",
        path, why);
  }

  /// Returns the columns that the table has.
  std::string found_columns() const {
    Query info(db, path, "pragma table_info(result)");
    std::string out;
    while (info.step()) out += (out.empty() ? "" : ", ") + info.text(1);
    return out;
  }

  std::string path;
  sqlite3* db = nullptr;
};

ResultDb::ResultDb(const std::string& path, Access access) : impl_(std::make_unique<Impl>(path, access)) {
  if (access != Access::kRead)
    impl_->execute("create table if not exists result (" + columns(true) + ", primary key (key))");
  if (impl_->found_columns() != columns(false))
    fail("{}: was made by another version of palpate, with other columns; start again with --fresh", path);
}

ResultDb::~ResultDb() = default;

void ResultDb::put(const ResultRow& row) {
  ResultRow copy = row;
  const auto texts = texts_of(copy);
  const auto numbers = numbers_of(copy);
  std::string placeholders;
  for (std::size_t i = 0; i < texts.size() + numbers.size(); ++i) placeholders += "?,";
  Query insert(impl_->db, impl_->path, "insert or replace into result values (" + placeholders + "?)");
  int i = 1;
  for (const auto& [name, value] : texts) insert.bind(i++, *value);
  for (const auto& [name, value] : numbers) insert.bind(i++, *value);
  insert.bind_blob(i, copy.bytes);
  insert.step();
}

std::optional<ResultRow> ResultDb::find(const std::string& key) const {
  Query select(impl_->db, impl_->path, "select * from result where key = ?");
  select.bind(1, key);
  if (!select.step()) return std::nullopt;
  return select.row();
}

std::vector<std::string> ResultDb::keys() const {
  Query select(impl_->db, impl_->path, "select key from result");
  std::vector<std::string> out;
  while (select.step()) out.push_back(select.text(0));
  return out;
}

long ResultDb::count() const {
  Query count(impl_->db, impl_->path, "select count(*) from result");
  count.step();
  return static_cast<long>(count.number(0));
}

void ResultDb::put_all(const ResultDb& other) {
  Query select(other.impl_->db, other.impl_->path, "select * from result");
  impl_->execute("begin");
  try {
    while (select.step()) put(select.row());
    impl_->execute("commit");
  } catch (...) {
    // Fails where SQLite has rolled back by itself, as it does for a full disk.
    sqlite3_exec(impl_->db, "rollback", nullptr, nullptr, nullptr);
    throw;
  }
}

void ResultDb::check_readable() const {
  Query select(impl_->db, impl_->path, "select * from result");
  while (select.step()) select.row();
}

}  // namespace palpate::store
