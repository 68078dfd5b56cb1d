#include "io/results/journal_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "base/version.h"

namespace axisfit {
namespace {

using Json = nlohmann::json;

std::string reason(int error) { return std::generic_category().message(error); }

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Every record is CBOR, which keeps all digits and what is not finite, behind its length and
/// checksum.
std::string framed(const Json& json) {
  std::string payload;
  Json::to_cbor(json, payload);
  const std::array<std::uint32_t, 2> frame{static_cast<std::uint32_t>(payload.size()),
                                           checksum(payload)};
  return std::string(reinterpret_cast<const char*>(frame.data()), sizeof frame) + payload;
}

/// Of a record, in bytes. A solution takes hundreds; what is nested thousands deep, as a forged one
/// may be, would exhaust the stack of the reader.
constexpr std::uint32_t kMaxBytes = 1 << 14;

/// Takes the first record off; none where it is not whole.
std::optional<Json> unframed(std::string_view& bytes) {
  std::array<std::uint32_t, 2> frame;
  if (bytes.size() < sizeof frame) return std::nullopt;
  std::memcpy(frame.data(), bytes.data(), sizeof frame);
  if (frame[0] > kMaxBytes) return std::nullopt;
  const std::string_view payload = bytes.substr(sizeof frame, frame[0]);
  if (payload.size() < frame[0] || checksum(payload) != frame[1]) return std::nullopt;
  Json json = Json::from_cbor(payload, true, false);
  if (json.is_discarded()) return std::nullopt;
  bytes.remove_prefix(sizeof frame + frame[0]);
  return json;
}

/// The first record, of the program that runs: another one might solve otherwise.
const std::string& origin() {
  static const std::string record = [] {
    std::ifstream self("/proc/self/exe", std::ios::binary);
    const std::string program{std::istreambuf_iterator<char>(self), {}};
    return framed({{"axisfit", version()}, {"program", checksum(program)}});
  }();
  return record;
}

Json to_json(const ProblemKey& key, const SolveResult& s) {
  return {{"key", key},
          {"usable", s.usable},
          {"converged", s.converged},
          {"u", std::vector<double>(s.u.begin(), s.u.end())},
          {"cost", s.cost},
          {"reduced_cost", s.reduced_cost},
          {"iterations", s.iterations},
          {"message", s.message}};
}

SolveResult from_json(const Json& json) {
  SolveResult s;
  s.usable = json.at("usable");
  s.converged = json.at("converged");
  const std::vector<double> u = json.at("u");
  s.u = Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  s.cost = json.at("cost");
  s.reduced_cost = json.at("reduced_cost");
  s.iterations = json.at("iterations");
  s.message = json.at("message");
  return s;
}

}  // namespace

JournalFile::JournalFile(const std::string& path) {
  open_and_lock(path);
  try {
    read();
    if (ftruncate(file_, static_cast<off_t>(end_)) != 0) throw std::runtime_error(reason(errno));
    if (end_ == 0) append(origin());
    if (!failure_.empty()) throw std::runtime_error(failure_);
  } catch (...) {
    if (end_ == 0) ::unlink(path.c_str());
    ::close(file_);
    throw;
  }
}

JournalFile::~JournalFile() { ::close(file_); }

void JournalFile::open_and_lock(const std::string& path) {
  for (;;) {
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file_ < 0) throw std::runtime_error(reason(errno));
    if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(file_);
      throw std::runtime_error(
          "another run is using this folder; wait until it has finished, or choose another folder");
    }  // where there are no locks it must do without
    // The run that had it may have removed it meanwhile.
    struct stat opened = {}, there = {};
    const bool same = fstat(file_, &opened) == 0 && stat(path.c_str(), &there) == 0 &&
                      opened.st_ino == there.st_ino && opened.st_dev == there.st_dev;
    if (same && S_ISREG(opened.st_mode)) return;
    ::close(file_);
    // To read a pipe could take for ever.
    if (same) throw std::runtime_error(path + " exists and is not a file; move it");
  }
}

void JournalFile::read() {
  std::string bytes;
  std::array<char, 1 << 16> chunk;
  for (ssize_t n; (n = ::read(file_, chunk.data(), chunk.size())) != 0;) {
    if (n < 0) throw std::runtime_error(reason(errno));
    bytes.append(chunk.data(), static_cast<std::size_t>(n));
  }
  if (!bytes.starts_with(origin())) return;
  end_ = origin().size();
  std::string_view remaining = std::string_view(bytes).substr(end_);
  try {
    while (const std::optional<Json> record = unframed(remaining)) {
      recovered_.emplace(record->at("key").get<ProblemKey>(), from_json(*record));
      end_ = bytes.size() - remaining.size();
    }
  } catch (const Json::exception&) {  // whole, but not of our making
  }
}

void JournalFile::append(const std::string& record) {
  const ssize_t written = ::pwrite(file_, record.data(), record.size(), static_cast<off_t>(end_));
  const bool whole = written == static_cast<ssize_t>(record.size());
  if (whole) end_ += record.size();
  failure_ = whole ? "" : reason(written < 0 ? errno : ENOSPC);
}

std::string JournalFile::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::optional<SolveResult> JournalFile::find(const ProblemKey& key) {
  if (!resuming_) return std::nullopt;
  const auto known = recovered_.find(key);
  return known == recovered_.end() ? std::nullopt : std::optional(known->second);
}

void JournalFile::store(const ProblemKey& key, const SolveResult& solution) {
  const std::string record = framed(to_json(key, solution));
  const std::lock_guard lock(mutex_);
  append(record);
  ++stored_;
}

}  // namespace axisfit
