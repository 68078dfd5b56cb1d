// axisfit._core: the library as Python sees it. What people use is python/axisfit, which is written
// in Python; here are the jobs, the runs and the simulations themselves.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "apps/result_files.h"
#include "apps/run_options.h"
#include "base/parallel.h"
#include "base/version.h"
#include "fit/run.h"
#include "init/machine_choice.h"
#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/diagnostics.h"
#include "io/config/job_file.h"
#include "io/config/motion_file.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "sim/rig.h"

namespace py = pybind11;
using namespace py::literals;

namespace axisfit {
namespace {

/// A series of doubles that are stored one behind the other.
using Array = py::array_t<double, py::array::c_style>;

/// A column of Python, for which no copy is made before this one.
std::vector<double> values_of(const Array& array, const std::string& name) {
  if (array.ndim() != 1)
    throw py::value_error("column '" + name + "' must have one dimension, not " +
                          std::to_string(array.ndim()));
  return {array.data(), array.data() + array.size()};
}

/// An array of numpy that takes over a vector.
py::array array_of(std::vector<double> values) {
  auto* owned = new std::vector<double>(std::move(values));
  const py::capsule owner(owned, [](void* p) { delete static_cast<std::vector<double>*>(p); });
  return Array(static_cast<py::ssize_t>(owned->size()), owned->data(), owner);
}

Tables tables_of(const py::dict& recordings) {
  Tables tables;
  for (const auto& [name, columns] : recordings) {
    Table table{.file = py::cast<std::string>(name), .columns = {}};
    for (const auto& [column, values] : py::cast<py::dict>(columns)) {
      const auto of_column = py::cast<std::string>(column);
      table.columns.push_back({of_column, values_of(py::cast<Array>(values), of_column)});
    }
    const std::string key = table.file;
    tables.emplace(key, std::move(table));
  }
  return tables;
}

/// Does work without the interpreter's lock, in a thread of its own, while this one looks after
/// Ctrl-C and reports progress. Where a signal's handler raises, the work is told to stop, and what
/// it returns then is kept until the error is on its way.
template <class Result>
class Work {
 public:
  /// What the work gave, and the error of the handler that stopped it.
  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr stopped;
  };

  template <class Function>
  Outcome run(const py::object& progress, std::optional<double> time_limit, Function&& function) {
    const auto begin = std::chrono::steady_clock::now();
    Outcome outcome;
    std::exception_ptr failed;
    std::thread worker([&] {
      try {
        const auto note = [&](const Progress& p) {
          const std::lock_guard lock(mutex_);
          latest_ = p;
        };
        outcome.result = function(RunContext{&stop_, nullptr, note, &search_over_});
      } catch (const Interrupted&) {
        // There is no result.
      } catch (...) {
        failed = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      done_ = true;
      changed_.notify_all();
    });
    for (bool done = false; !done;) {
      {
        const py::gil_scoped_release others_run;
        std::unique_lock lock(mutex_);
        constexpr auto kLook = std::chrono::milliseconds(50);
        done = changed_.wait_for(lock, kLook, [&] { return done_; });
      }
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      if (time_limit && spent.count() > kPartOfSearch * *time_limit) search_over_.set();
      if (time_limit && spent.count() > *time_limit) stop_.set();
      if (outcome.stopped) continue;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) report(progress);
      } catch (...) {
        outcome.stopped = std::current_exception();
        stop_.set();
      }
    }
    {
      const py::gil_scoped_release others_run;
      worker.join();
    }
    if (failed && !outcome.stopped) std::rethrow_exception(failed);
    return outcome;
  }

 private:
  void report(const py::object& progress) {
    std::optional<Progress> latest;
    {
      const std::lock_guard lock(mutex_);
      latest.swap(latest_);
    }
    if (latest) progress(latest->phase, latest->done, latest->of, latest->best);
  }

  StopFlag stop_;
  StopFlag search_over_{&stop_};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Progress> latest_;
  bool done_ = false;
};

/// A job as read, with how it was made.
struct PyJob {
  JobFile file;
  std::string origin;  ///< its file, or what stands for it
  std::string data;
};

struct PyResult {
  JobFile file;
  std::string origin, data;
  RunResult run;
  std::string json;

  Files files(const std::string& output) const {
    return result_files(file, run, json, {"axisfit.fit", origin, data, output});
  }
};

std::vector<std::string> names_of(const Job& job) {
  std::vector<std::string> names;
  for (const FreeParameter& p : job.free) names.push_back(name_of(job, p));
  return names;
}

/// Of the estimates, rows and columns in the order of the parameters; NaN where one is not known.
py::array covariance(const RunResult& result) {
  const FitResult& fit = result.fit();
  const auto n = static_cast<py::ssize_t>(fit.parameters.size());
  Array matrix({n, n});
  for (py::ssize_t i = 0; i < n; ++i)
    for (py::ssize_t j = 0; j < n; ++j) {
      const auto error = [&](py::ssize_t k) {
        const ParameterUncertainty& u = fit.parameters[static_cast<std::size_t>(k)].uncertainty;
        return u.determined && !u.at_bound ? u.standard_error
                                           : std::numeric_limits<double>::quiet_NaN();
      };
      const double correlation = i == j ? 1.0
                                 : fit.correlation.rows() == n
                                     ? fit.correlation(i, j)
                                     : std::numeric_limits<double>::quiet_NaN();
      matrix.mutable_at(i, j) = correlation * error(i) * error(j);
    }
  return matrix;
}

PyJob read_job(const std::string& path, const std::string& data) {
  return {read_job_file(path, data), path, data};
}

PyJob make_job(const Files& files, const std::string& folder, const py::dict& recordings) {
  Tables tables = tables_of(recordings);
  const py::gil_scoped_release others_run;
  return {read_job_draft(files, folder, std::move(tables)), files.back().first, ""};
}

/// What fit-params does with a job between its files. Raises what stopped it, with the result as
/// its attribute `result` where there is one.
std::unique_ptr<PyResult> fit(const PyJob& job, const RunOptions& options,
                              std::optional<int> threads, std::optional<int> starts,
                              std::optional<std::uint64_t> seed, std::optional<double> time_limit,
                              const py::object& progress) {
  JobFile file = job.file;
  FitOptions& fit_options = file.job.options;
  if (threads) fit_options.threads = *threads;
  if (starts) fit_options.starts = *starts;
  if (seed) fit_options.seed = *seed;
  Work<RunResult> work;
  auto [run_result, stopped] = work.run(progress, time_limit, [&](const RunContext& context) {
    return run(file.job, options, context);
  });
  if (run_result && run_result->interrupted && !stopped) run_result->time_limit = time_limit;
  if (!run_result && !stopped) {
    PyErr_SetString(PyExc_TimeoutError, "stopped by the time limit before any fit finished");
    throw py::error_already_set();
  }
  std::unique_ptr<PyResult> result;
  if (run_result) {
    result = std::make_unique<PyResult>(
        PyResult{std::move(file), job.origin, job.data, *std::move(run_result), {}});
    result->json = result_json(result->run).dump(2) + "\n";
  }
  if (!stopped) return result;
  try {
    std::rethrow_exception(stopped);
  } catch (py::error_already_set& error) {
    if (result && PyObject_HasAttrString(error.value().ptr(), "__dict__") != 0)
      error.value().attr("result") = py::cast(std::move(result));
    throw;
  }
}

RunOptions options_of(const PyJob& job, bool close_loop, const std::vector<std::string>& profiles,
                      bool suggest_experiment, bool predict, const std::string& motion,
                      const std::vector<std::string>& within, bool compare,
                      const std::vector<std::string>& others) {
  RunOptions options;
  options.select_effects = close_loop;
  options.suggest_experiment = suggest_experiment;
  options.predict = predict || !motion.empty();
  options.compare = compare;
  options.others = models_of(others, job.file.job);
  for (const std::string& text : within)
    options.tolerances.push_back(tolerance_of(text, job.file.job));
  if (!motion.empty()) options.motion = motion_of(motion, job.file.rig);
  set_profiles(profiles, job.file.job, options);
  return options;
}

Rig rig_of(const std::string& text, const std::string& name) {
  Diagnostics diagnostics;
  const auto root = ConfigNode::parse(text, name, diagnostics);
  auto rig = root ? read_axis(*root, diagnostics) : std::nullopt;
  diagnostics.throw_if_any();
  return *std::move(rig);
}

py::dict simulate(const std::string& axis, const std::string& name, const std::string& motion,
                  const std::vector<std::string>& signals, double rate, std::uint64_t seed,
                  bool exact, bool band) {
  const Rig rig = rig_of(axis, name);
  const MotionFile file = read_motion_file(motion, rig);
  RecordingOptions options;
  options.duration = file.duration;
  options.rate = rate;
  options.seed = seed;
  options.noise = !exact;
  const Structure& structure = rig.model.structure;
  for (const std::string& signal : signals) {
    const auto found = signal_by_name(signal, vocabulary_of(structure));
    if (!found || !has_signal(*found, structure))
      throw py::value_error("this axis has no signal '" + signal + "'");
    options.signals.push_back(*found);
  }
  std::vector<Column> columns;
  {
    const py::gil_scoped_release others_run;
    const ThreadPool pool(0);
    columns =
        band ? record_with_bands(rig, file.motion, options) : record(rig, file.motion, options);
  }
  py::dict result;
  for (Column& column : columns) result[py::str(column.name)] = array_of(std::move(column.values));
  return result;
}

/// A job for recordings: files to write, and what was guessed.
py::tuple init(const std::vector<std::string>& recordings, const std::string& folder,
               const std::string& axis, const std::string& machine, std::optional<double> gain,
               const std::vector<std::string>& columns, const std::string& rate,
               const std::string& motor, const py::object& progress) {
  InitRequest request{.recordings = recordings,
                      .folder = folder,
                      .axis = machine.empty() ? axis : machine,
                      .is_machine = !machine.empty(),
                      .gain = gain,
                      .answers = {.motor = motor}};
  for (const std::string& text : columns) request.answers.columns.push_back(read_answer(text));
  if (!rate.empty()) request.answers.rate = read_rate(rate);
  Work<MachineChoice> work;
  auto [choice, stopped] = work.run(progress, {}, [&](const RunContext& context) -> MachineChoice {
    if (request.axis.empty() && !request.gain) return choose_machine(request, context);
    MachineChoice one;
    one.job = initial_job(request, context);
    return one;
  });
  if (stopped) std::rethrow_exception(stopped);
  return py::make_tuple(choice->job.files, choice->job.guesses);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.attr("__version__") = version();
  // What Python shows of mistakes: the messages of the programs, and each place by itself.
  static py::exception<ConfigError> job_error(module, "JobError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ConfigError& error) {
      py::list places;
      for (const Diagnostic& d : error.diagnostics())
        places.append(py::make_tuple(d.file, d.line, d.column, d.message));
      const py::object& type = job_error;
      py::object raised = type(py::str(error.what()));
      raised.attr("diagnostics") = places;
      PyErr_SetObject(job_error.ptr(), raised.ptr());
    }
  });

  py::class_<PyJob>(module, "Job")
      .def_property_readonly("names", [](const PyJob& job) { return names_of(job.file.job); })
      .def_property_readonly("axis_text", [](const PyJob& job) { return job.file.axis_text; })
      .def_property_readonly("axis_file", [](const PyJob& job) { return job.file.axis_file; })
      .def_property_readonly("text", [](const PyJob& job) { return job.file.text; })
      .def_readonly("origin", &PyJob::origin)
      .def_property_readonly("recordings", [](const PyJob& job) {
        std::vector<std::string> names;
        for (const Recording& r : job.file.job.recordings) names.push_back(r.name);
        return names;
      });
  py::class_<PyResult>(module, "Result")
      .def_readonly("json", &PyResult::json)
      .def("text", [](const PyResult& r) { return report_text(r.run, false); })
      .def("html",
           [](const PyResult& r) {
             return report_page(
                 r.run, {"axisfit.fit", r.origin, r.file.text, r.file.axis_file, r.file.axis_text});
           })
      .def("files", &PyResult::files, "output"_a)
      .def("residuals_csv",
           [](const PyResult& r) {
             return residuals_csv(r.run.job(), r.run.fit(), r.run.diagnosis);
           })
      .def("prediction_csv", [](const PyResult& r) { return prediction_csv(r.run); })
      .def("covariance", [](const PyResult& r) { return covariance(r.run); })
      .def(
          "save",
          [](const PyResult& r, const std::string& output, const std::string& go_on) {
            OutputFolder folder(output, result_names(), r.file.files);
            folder.write(r.files(go_on), !r.run.interrupted);
          },
          "output"_a, "go_on"_a);

  module.def("read_job", &read_job, "path"_a, "data"_a);
  module.def("make_job", &make_job, "files"_a, "folder"_a, "recordings"_a);
  module.def(
      "fit",
      [](const PyJob& job, bool close_loop, const std::vector<std::string>& profiles,
         bool suggest_experiment, bool predict, const std::string& motion,
         const std::vector<std::string>& within, bool compare,
         const std::vector<std::string>& others, std::optional<int> threads,
         std::optional<int> starts, std::optional<std::uint64_t> seed,
         std::optional<double> time_limit, const py::object& progress) {
        return fit(job,
                   options_of(job, close_loop, profiles, suggest_experiment, predict, motion,
                              within, compare, others),
                   threads, starts, seed, time_limit, progress);
      },
      "job"_a, "close_loop"_a, "profiles"_a, "suggest_experiment"_a, "predict"_a, "motion"_a,
      "within"_a, "compare"_a, "others"_a, "threads"_a, "starts"_a, "seed"_a, "time_limit"_a,
      "progress"_a);
  module.def("simulate", &simulate, "axis"_a, "name"_a, "motion"_a, "signals"_a, "rate"_a, "seed"_a,
             "exact"_a, "band"_a);
  module.def("init", &init, "recordings"_a, "folder"_a, "axis"_a, "machine"_a, "gain"_a,
             "columns"_a, "rate"_a, "motor"_a, "progress"_a);
}

}  // namespace axisfit
