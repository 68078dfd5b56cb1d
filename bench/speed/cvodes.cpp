#include "bench/speed/cvodes.h"

#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <stdexcept>

namespace axisfit::speed {
namespace {

void require(int flag, const char* call) {
  if (flag < 0) throw std::runtime_error(std::string(call) + " fails: " + std::to_string(flag));
}

State<double> state_of(N_Vector y) {
  State<double> state{};
  std::copy_n(N_VGetArrayPointer(y), kPaperStates, state.begin());
  return state;
}

template <int N>
class Solver {
 public:
  Solver(const Work& work, const Scales& scales, const CvodesOptions& options)
      : work_(work), options_(options), axis_(work) {
    require(SUNContext_Create(nullptr, &context_), "SUNContext_Create");
    constexpr auto n = static_cast<sunindextype>(kPaperStates);
    y_ = N_VNew_Serial(n, context_);
    tolerances_ = N_VClone(y_);
    sensitivities_ = N_VCloneVectorArray(N, y_);
    put(axis_.start());
    for (std::size_t i = 0; i < kPaperStates; ++i)
      N_VGetArrayPointer(tolerances_)[i] = options.tolerance * scales.states[i];
    memory_ = CVodeCreate(CV_BDF, context_);
    require(CVodeInit(memory_, rate, 0.0, y_), "CVodeInit");
    require(CVodeSVtolerances(memory_, options.tolerance, tolerances_), "CVodeSVtolerances");
    require(CVodeSetUserData(memory_, this), "CVodeSetUserData");
    require(CVodeSetMaxNumSteps(memory_, 10'000'000), "CVodeSetMaxNumSteps");
    matrix_ = SUNDenseMatrix(n, n, context_);
    linear_ = SUNLinSol_Dense(y_, matrix_, context_);
    require(CVodeSetLinearSolver(memory_, linear_, matrix_), "CVodeSetLinearSolver");
    if (options.supplied) require(CVodeSetJacFn(memory_, jacobian), "CVodeSetJacFn");
    // Sensitivities with respect to the parameters themselves, dy/dp, as CVODES wants them.
    require(CVodeSensInit(memory_, N, method(), options.supplied ? sensitivity_rate : nullptr,
                          sensitivities_),
            "CVodeSensInit");
    for (int k = 0; k < N; ++k) plist_[static_cast<std::size_t>(k)] = k;
    pbar_ = axis_.parameters();
    require(CVodeSetSensParams(memory_, options.supplied ? nullptr : axis_.parameters().data(),
                               pbar_.data(), plist_.data()),
            "CVodeSetSensParams");
    require(CVodeSensEEtolerances(memory_), "CVodeSensEEtolerances");
    require(CVodeSetSensErrCon(memory_, SUNTRUE), "CVodeSetSensErrCon");
    find_roots();
  }
  ~Solver() {
    CVodeFree(&memory_);
    SUNLinSolFree(linear_);
    SUNMatDestroy(matrix_);
    N_VDestroyVectorArray(sensitivities_, N);
    N_VDestroy(tolerances_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  Trajectory run() {
    Trajectory trajectory;
    trajectory.parameters = N;
    trajectory.template add<N>(get());
    for (std::size_t i = 1; i < work_.times.size(); ++i) {
      double t = 0.0;
      for (;;) {
        const int flag = CVode(memory_, work_.times[i], y_, &t, CV_NORMAL);
        require(flag, "CVode");
        require(CVodeGetSens(memory_, &t, sensitivities_), "CVodeGetSens");
        if (flag != CV_ROOT_RETURN) break;
        std::vector<int> found(directions_.size());
        require(CVodeGetRootInfo(memory_, found.data()), "CVodeGetRootInfo");
        const auto met = std::ranges::find_if(found, [](int f) { return f != 0; });
        put(axis_.pass(static_cast<int>(met - found.begin()), get()));
        require(CVodeReInit(memory_, t, y_), "CVodeReInit");
        require(CVodeSensReInit(memory_, method(), sensitivities_), "CVodeSensReInit");
        find_roots();
      }
      trajectory.template add<N>(get());
    }
    return trajectory;
  }

 private:
  int method() const { return options_.simultaneous ? CV_SIMULTANEOUS : CV_STAGGERED; }

  void find_roots() {
    const int n = axis_.visit_guards(state_of(y_), [](int, double) {});
    directions_.assign(static_cast<std::size_t>(n), -1);
    require(CVodeRootInit(memory_, n, guards), "CVodeRootInit");
    require(CVodeSetRootDirection(memory_, directions_.data()), "CVodeSetRootDirection");
    require(CVodeSetNoInactiveRootWarn(memory_), "CVodeSetNoInactiveRootWarn");
  }

  void put(const State<Jet<N>>& y) {
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      N_VGetArrayPointer(y_)[i] = y[i].a;
      for (int k = 0; k < N; ++k)
        N_VGetArrayPointer(sensitivities_[k])[i] =
            y[i].v[k] / axis_.parameters()[static_cast<std::size_t>(k)];
    }
  }
  State<Jet<N>> get() const { return jets(y_, sensitivities_); }
  State<Jet<N>> jets(N_Vector y, N_Vector* sensitivities) const {
    State<Jet<N>> state{};
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      state[i].a = N_VGetArrayPointer(y)[i];
      for (int k = 0; k < N; ++k)
        state[i].v[k] = N_VGetArrayPointer(sensitivities[k])[i] *
                        axis_.parameters()[static_cast<std::size_t>(k)];
    }
    return state;
  }

  static int rate(double, N_Vector y, N_Vector derivative, void* self) {
    const State<double> d = static_cast<Solver*>(self)->axis_.rate(state_of(y));
    std::copy_n(d.begin(), kPaperStates, N_VGetArrayPointer(derivative));
    return 0;
  }
  static int jacobian(double, N_Vector, N_Vector, SUNMatrix a, void* self, N_Vector, N_Vector,
                      N_Vector) {
    const Matrix<double> matrix = static_cast<Solver*>(self)->axis_.matrix();
    for (std::size_t i = 0; i < kPaperStates; ++i)
      for (std::size_t j = 0; j < kPaperStates; ++j) SM_ELEMENT_D(a, i, j) = matrix[i][j];
    return 0;
  }
  static int sensitivity_rate(int, double, N_Vector y, N_Vector, N_Vector* sensitivities,
                              N_Vector* derivatives, void* self, N_Vector, N_Vector) {
    const Solver& solver = *static_cast<Solver*>(self);
    const State<Jet<N>> d = solver.axis_.rate(solver.jets(y, sensitivities));
    for (std::size_t i = 0; i < kPaperStates; ++i)
      for (int k = 0; k < N; ++k)
        N_VGetArrayPointer(derivatives[k])[i] =
            d[i].v[k] / solver.axis_.parameters()[static_cast<std::size_t>(k)];
    return 0;
  }
  static int guards(double, N_Vector y, double* values, void* self) {
    static_cast<Solver*>(self)->axis_.visit_guards(state_of(y),
                                                   [&](int i, double g) { values[i] = g; });
    return 0;
  }

  const Work& work_;
  CvodesOptions options_;
  Axis<N> axis_;
  SUNContext context_ = nullptr;
  void* memory_ = nullptr;
  N_Vector y_ = nullptr, tolerances_ = nullptr;
  N_Vector* sensitivities_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
  std::vector<int> directions_;
  std::array<int, N> plist_{};
  std::array<double, N> pbar_{};
};

}  // namespace

template <int N>
Trajectory by_cvodes(const Work& work, const Scales& scales, const CvodesOptions& options) {
  return Solver<N>(work, scales, options).run();
}

template Trajectory by_cvodes<1>(const Work&, const Scales&, const CvodesOptions&);
template Trajectory by_cvodes<5>(const Work&, const Scales&, const CvodesOptions&);
template Trajectory by_cvodes<10>(const Work&, const Scales&, const CvodesOptions&);
template Trajectory by_cvodes<20>(const Work&, const Scales&, const CvodesOptions&);

}  // namespace axisfit::speed
