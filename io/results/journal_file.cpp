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

/// CBOR in bytes. It takes hundreds; what is nested thousands deep, as a forged one may be, would
/// exhaust the stack of the reader.
constexpr std::uint32_t kMaxBytes = 1 << 14;

/// Every record is CBOR, which keeps what is not finite, and numbers as they are in memory, of
/// which there may be any number, behind the size of either and the checksum of both.
struct Record {
  Json json;
  std::vector<double> numbers{};
};

using Frame = std::array<std::uint32_t, 3>;

std::string framed(const Record& record) {
  std::string payload;
  Json::to_cbor(record.json, payload);
  const auto size = static_cast<std::uint32_t>(payload.size());
  payload.append(reinterpret_cast<const char*>(record.numbers.data()),
                 record.numbers.size() * sizeof(double));
  const Frame frame{size, static_cast<std::uint32_t>(record.numbers.size()), checksum(payload)};
  return std::string(reinterpret_cast<const char*>(frame.data()), sizeof frame) + payload;
}

/// Takes the first record off; none where it is not whole.
std::optional<Record> unframed(std::string_view& bytes) {
  Frame frame;
  if (bytes.size() < sizeof frame) return std::nullopt;
  std::memcpy(frame.data(), bytes.data(), sizeof frame);
  if (frame[0] > kMaxBytes) return std::nullopt;
  const std::size_t size = frame[0] + std::size_t{frame[1]} * sizeof(double);
  const std::string_view payload = bytes.substr(sizeof frame, size);
  if (payload.size() < size || checksum(payload) != frame[2]) return std::nullopt;
  Record record{Json::from_cbor(payload.substr(0, frame[0]), true, false)};
  if (record.json.is_discarded()) return std::nullopt;
  record.numbers.resize(frame[1]);
  std::memcpy(record.numbers.data(), payload.data() + frame[0], size - frame[0]);
  bytes.remove_prefix(sizeof frame + size);
  return record;
}

/// The first record, of the program that runs: another one might solve otherwise.
const std::string& origin() {
  static const std::string record = [] {
    std::ifstream self("/proc/self/exe", std::ios::binary);
    const std::string program{std::istreambuf_iterator<char>(self), {}};
    return framed({{{JournalFile::kSignature, version()}, {"program", checksum(program)}}});
  }();
  return record;
}

Record record_of(const ProblemKey& key, const SolveResult& s) {
  return {{{"key", key},
           {"usable", s.usable},
           {"converged", s.converged},
           {"cost", s.cost},
           {"reduced_cost", s.reduced_cost},
           {"iterations", s.iterations},
           {"message", s.message}},
          {s.u.begin(), s.u.end()}};
}

SolveResult solution_of(const Record& record) {
  SolveResult s;
  const auto& [json, u] = record;
  s.usable = json.at("usable");
  s.converged = json.at("converged");
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
    while (const std::optional<Record> record = unframed(remaining)) {
      recovered_.emplace(record->json.at("key").get<ProblemKey>(), solution_of(*record));
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
  const std::string record = framed(record_of(key, solution));
  const std::lock_guard lock(mutex_);
  append(record);
  ++stored_;
}

}  // namespace axisfit
