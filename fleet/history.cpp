#include "fleet/history.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "base/plain_text.h"

namespace axisfit {
namespace {

constexpr int kVersion = 1;
constexpr int kApplication = 0x61786673;  // "axfs"
constexpr const char* kTables = R"(
CREATE TABLE nights(id INTEGER PRIMARY KEY, axis TEXT NOT NULL, night TEXT NOT NULL,
  status TEXT NOT NULL, reason TEXT NOT NULL, fingerprint TEXT NOT NULL, tool TEXT NOT NULL,
  seconds REAL, UNIQUE(axis, night));
CREATE TABLE parameters(night INTEGER NOT NULL REFERENCES nights ON DELETE CASCADE,
  name TEXT NOT NULL, unit TEXT NOT NULL, value REAL, standard_error REAL,
  PRIMARY KEY(night, name)) WITHOUT ROWID;
CREATE TABLE residuals(night INTEGER NOT NULL REFERENCES nights ON DELETE CASCADE,
  recording TEXT NOT NULL, signal TEXT NOT NULL, unit TEXT NOT NULL, role TEXT NOT NULL,
  rmse REAL, chi_square REAL, PRIMARY KEY(night, recording, signal)) WITHOUT ROWID;
CREATE TABLE effects(night INTEGER NOT NULL REFERENCES nights ON DELETE CASCADE,
  name TEXT NOT NULL, PRIMARY KEY(night, name)) WITHOUT ROWID;
CREATE TABLE channels(night INTEGER NOT NULL REFERENCES nights ON DELETE CASCADE,
  name TEXT NOT NULL, mean REAL, PRIMARY KEY(night, name)) WITHOUT ROWID;
)";

}  // namespace

/// A statement that is prepared once and run with different values.
class History::Statement {
 public:
  Statement(const History& history, const char* sql) : history_(history) {
    if (sqlite3_prepare_v2(history.database_, sql, -1, &statement_, nullptr) != SQLITE_OK)
      history.fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  template <class... Values>
  void run(const Values&... values) {
    begin(values...);
    while (next()) {
    }
  }
  template <class... Values>
  void begin(const Values&... values) {
    sqlite3_reset(statement_);
    int place = 0;
    (bind(++place, values), ...);
  }
  /// Whether there is another row.
  bool next() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) history_.fail();
    return result == SQLITE_ROW;
  }
  std::string text(int column) const {
    const unsigned char* found = sqlite3_column_text(statement_, column);
    return found == nullptr ? "" : reinterpret_cast<const char*>(found);
  }
  double number(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL
               ? std::numeric_limits<double>::quiet_NaN()
               : sqlite3_column_double(statement_, column);
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }

 private:
  void bind(int place, std::string_view text) {
    check(sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()),
                            SQLITE_TRANSIENT));
  }
  void bind(int place, const std::string& text) { bind(place, std::string_view(text)); }
  void bind(int place, double value) {
    check(std::isfinite(value) ? sqlite3_bind_double(statement_, place, value)
                               : sqlite3_bind_null(statement_, place));
  }
  void bind(int place, std::int64_t value) { check(sqlite3_bind_int64(statement_, place, value)); }
  void check(int result) const {
    if (result != SQLITE_OK) history_.fail();
  }

  const History& history_;
  sqlite3_stmt* statement_ = nullptr;
};

void History::fail() const {
  throw std::runtime_error(
      fmt::format("history {}: {}", in_quotes(path_),
                  database_ != nullptr ? sqlite3_errmsg(database_) : "no memory"));
}

void History::execute(const std::string& sql) const {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

History::History(const std::string& path) : path_(path) {
  const int opened = sqlite3_open(path.c_str(), &database_);
  try {
    if (opened != SQLITE_OK) fail();
    sqlite3_busy_timeout(database_, 60'000);  // ms: another merge may be at work
    execute("PRAGMA foreign_keys = ON; BEGIN IMMEDIATE");
    const auto pragma = [&](const char* name) {
      Statement read(*this, name);
      read.begin();
      return read.next() ? read.integer(0) : 0;
    };
    const std::int64_t version = pragma("PRAGMA user_version"),
                       application = pragma("PRAGMA application_id");
    const bool is_new = pragma("SELECT count(*) FROM sqlite_schema") == 0;
    if (is_new) {
      execute(kTables);
      execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplication,
                          kVersion));
    } else if (application != kApplication) {
      throw std::runtime_error(
          fmt::format("{} is a database, but no history of a fleet", in_quotes(path)));
    } else if (version > kVersion) {
      throw std::runtime_error(fmt::format(
          "history {} is of version {}, which a later axisfit has made; this one knows version {}",
          in_quotes(path), version, kVersion));
    }
    execute("COMMIT");
  } catch (...) {
    sqlite3_close(database_);
    throw;
  }
}

History::~History() { sqlite3_close(database_); }

std::map<std::pair<std::string, std::string>, History::Entry> History::entries() const {
  std::map<std::pair<std::string, std::string>, Entry> found;
  Statement read(*this, "SELECT axis, night, fingerprint, tool, status FROM nights");
  for (read.begin(); read.next();)
    found[{read.text(0), read.text(1)}] = {read.text(2), read.text(3), read.text(4)};
  return found;
}

void History::add(const std::vector<NightResult>& results, const std::string& tool) {
  execute("BEGIN IMMEDIATE");
  try {
    Statement remove(*this, "DELETE FROM nights WHERE axis = ? AND night = ?"),
        night(*this,
              "INSERT INTO nights(axis, night, status, reason, fingerprint, tool, seconds) "
              "VALUES(?, ?, ?, ?, ?, ?, ?)"),
        parameter(*this, "INSERT INTO parameters VALUES(?, ?, ?, ?, ?)"),
        residual(*this, "INSERT INTO residuals VALUES(?, ?, ?, ?, ?, ?, ?)"),
        effect(*this, "INSERT OR IGNORE INTO effects VALUES(?, ?)"),
        channel(*this, "INSERT INTO channels VALUES(?, ?, ?)");
    for (const NightResult& r : results) {
      remove.run(r.axis, r.night);
      night.run(r.axis, r.night, r.status, r.reason, r.fingerprint, tool, r.seconds);
      const std::int64_t id = sqlite3_last_insert_rowid(database_);
      for (const auto& p : r.parameters)
        parameter.run(id, p.name, p.unit, p.value, p.standard_error);
      for (const auto& s : r.residuals)
        residual.run(id, s.recording, s.signal, s.unit, s.role, s.rmse, s.chi_square);
      for (const std::string& name : r.effects) effect.run(id, name);
      for (const auto& c : r.channels) channel.run(id, c.name, c.mean);
    }
    execute("COMMIT");
  } catch (...) {
    sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::vector<NightResult> History::results() const {
  std::vector<NightResult> all;
  std::map<std::int64_t, std::size_t> places;
  Statement nights(*this,
                   "SELECT id, axis, night, status, reason, fingerprint, seconds FROM nights "
                   "ORDER BY axis, night");
  for (nights.begin(); nights.next();) {
    places[nights.integer(0)] = all.size();
    NightResult& r = all.emplace_back();
    r.axis = nights.text(1);
    r.night = nights.text(2);
    r.status = nights.text(3);
    r.reason = nights.text(4);
    r.fingerprint = nights.text(5);
    r.seconds = nights.number(6);
  }
  const auto each = [&](const char* sql, const auto& add) {
    Statement read(*this, sql);
    for (read.begin(); read.next();) add(all[places.at(read.integer(0))], read);
  };
  each("SELECT night, name, unit, value, standard_error FROM parameters",
       [](NightResult& r, const Statement& s) {
         r.parameters.push_back({s.text(1), s.text(2), s.number(3), s.number(4)});
       });
  each("SELECT night, recording, signal, unit, role, rmse, chi_square FROM residuals",
       [](NightResult& r, const Statement& s) {
         r.residuals.push_back(
             {s.text(1), s.text(2), s.text(3), s.text(4), s.number(5), s.number(6)});
       });
  each("SELECT night, name FROM effects",
       [](NightResult& r, const Statement& s) { r.effects.push_back(s.text(1)); });
  each("SELECT night, name, mean FROM channels", [](NightResult& r, const Statement& s) {
    r.channels.push_back({s.text(1), s.number(2)});
  });
  return all;
}

}  // namespace axisfit
