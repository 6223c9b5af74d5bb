//! Plans for many agents: instances, what came of planning them, certificates.

use std::cell::RefCell;
use std::path::PathBuf;

use cohaul_core::se2;
use cohaul_planner::car;
use cohaul_planner::io::schedule::Statistics;
use cohaul_planner::io::{Document, FormatError};
use cohaul_planner::outcome::Outcome;
use cohaul_sim::planning::generate::{self, Kind, Wanted};
use cohaul_sim::planning::{self, Answer, AnyPlan, Planner, Request, Source, report};
use cohaul_sim::stopwatch::Stopwatch;
use numpy::PyArray;
use numpy::ndarray::Ix2;
use pyo3::prelude::*;

use crate::command::Signals;
use crate::{convert, error};

/// Wall time between two looks at Ctrl-C, s: each one waits for the interpreter.
const LOOK: f64 = 0.02;

/// The text of the instance of `kind` that a seed gives.
#[pyfunction]
pub fn generate_instance(
    py: Python<'_>,
    kind: &str,
    agents: usize,
    size: Option<u16>,
    obstacles: Option<usize>,
    window: usize,
    seed: u64,
) -> PyResult<String> {
    let known = Kind::named(kind).filter(|kind| *kind != Kind::Movingai);
    let kind = known.ok_or_else(|| {
        error::plan(format!(
            "kind is {kind:?}, must be 'grid', 'grid-all', 'grid-window', 'car', 'car-all', 'car-window', 'forward-car' or 'differential'"
        ))
    })?;
    let wanted = Wanted { kind, agents, size, obstacles, window };
    let made = py.detach(|| generate::made(&wanted, seed)).map_err(|e| error::file(e.into()))?;
    // one file for every kind but MovingAI's
    Ok(made.into_iter().map(|(_, text)| text).collect())
}

fn touching(model: &str) -> PyResult<car::Model> {
    match model {
        "clcbs" => Ok(car::Model::Clcbs),
        "exact" => Ok(car::Model::Exact),
        _ => Err(error::plan(format!("model is {model:?}, must be 'clcbs' or 'exact'"))),
    }
}

fn metric(name: &str) -> PyResult<car::Metric> {
    match name {
        "curve" => Ok(car::Metric::Curve),
        "manhattan" => Ok(car::Metric::Manhattan),
        _ => Err(error::plan(format!("metric is {name:?}, must be 'curve' or 'manhattan'"))),
    }
}

fn planner(name: &str) -> PyResult<Planner> {
    let names = || Planner::NAMES.map(|(name, _)| format!("'{name}'")).join(", ");
    Planner::named(name).ok_or_else(|| error::plan(format!("planner is {name:?}, must be one of {}", names())))
}

/// A planning instance.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct Instance {
    document: Document,
    title: String,
}

#[pymethods]
impl Instance {
    /// Reads the file at `path`, or `text` in its place; `starts` is `checked` or `free`.
    #[staticmethod]
    #[pyo3(signature = (path, text, map, vehicle, agents, starts))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        text: Option<&str>,
        map: Option<PathBuf>,
        vehicle: Option<PathBuf>,
        agents: Option<usize>,
        starts: &str,
    ) -> PyResult<Self> {
        let free_starts = match starts {
            "checked" => false,
            "free" => true,
            _ => return Err(error::plan(format!("starts is {starts:?}, must be 'checked' or 'free'"))),
        };
        let source = Source { map, vehicle, agents, free_starts };
        let read = py.detach(|| match text {
            Some(text) => planning::parse(text, &path, &source),
            None => planning::read(&path, &source),
        });
        let title = path.file_stem().unwrap_or_default().display().to_string();
        Ok(Self { document: read.map_err(error::file)?, title })
    }

    /// How many agents there are.
    #[getter]
    fn agents(&self) -> usize {
        self.document.instance.agents()
    }

    /// Plans without holding the interpreter, until `timeout` seconds of CPU time are spent.
    #[expect(clippy::too_many_arguments, reason = "Python gathers them")]
    #[pyo3(signature = (planner, bound, model, batch, metric, timeout))]
    fn plan(
        slf: Py<Self>,
        py: Python<'_>,
        planner: Option<&str>,
        bound: Option<f64>,
        model: &str,
        batch: Option<usize>,
        metric: &str,
        timeout: f64,
    ) -> PyResult<Planned> {
        if let Some(bound) = bound.filter(|bound| !(bound.is_finite() && *bound >= 1.0)) {
            return Err(error::plan(format!("bound is {bound}, must be a number of at least 1")));
        }
        if timeout.is_nan() || timeout < 0.0 {
            return Err(error::plan(format!("timeout is {timeout}, must not be negative")));
        }
        if batch == Some(0) {
            return Err(error::plan("batch is 0, must be at least 1".to_owned()));
        }
        let instance = &slf.get().document.instance;
        let planner = planner.map_or_else(|| Ok(Planner::for_instance(instance)), self::planner)?;
        let request =
            Request { planner, bound, model: touching(model)?, batch, metric: self::metric(metric)?, timeout };
        let mut signals = Signals::default();
        let watch = Stopwatch::start();
        let answer = py.detach(|| {
            let state = RefCell::new((&mut signals, 0.0));
            let interrupted = || {
                let (signals, looked) = &mut *state.borrow_mut();
                let now = watch.seconds().1;
                if now - *looked < LOOK {
                    return false;
                }
                *looked = now;
                signals.are_raised()
            };
            planning::solve(instance, &request, &watch, &interrupted)
        });
        signals.check()?;
        let usual = || Planner::for_instance(instance).name();
        let answer = answer.ok_or_else(|| {
            error::plan(format!("{} is not for an instance of this kind; use {}", planner.name(), usual()))
        })?;
        Ok(Planned { instance: slf, answer, request })
    }

    /// What is wrong with the plan in the file at `path`, or with `text` in its place: a JSON list.
    #[pyo3(signature = (path, text, model))]
    fn certify(&self, py: Python<'_>, path: PathBuf, text: Option<&str>, model: &str) -> PyResult<String> {
        let model = touching(model)?;
        let listed = py.detach(|| {
            let plan = match text {
                Some(text) => AnyPlan::parse(text, &path.display().to_string(), &self.document)?,
                None => AnyPlan::read(&path, &self.document)?,
            };
            Ok(report::violations(&plan.violations(&self.document.instance, model), &self.document.instance))
        });
        Ok(listed.map_err(error::file)?.to_string())
    }
}

/// What came of planning an instance.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct Planned {
    instance: Py<Instance>,
    answer: Answer,
    request: Request,
}

/// Name, goal and states of every agent.
type Routes<'py, T> = Vec<(String, Option<usize>, Bound<'py, PyArray<T, Ix2>>)>;

impl Planned {
    fn document(&self) -> &Document {
        &self.instance.get().document
    }

    fn solved(&self) -> PyResult<&AnyPlan> {
        match &self.answer.outcome {
            Outcome::Solved(plan) => Ok(plan),
            _ => Err(error::plan(format!("there is no plan: {}", report::status(&self.answer.outcome)))),
        }
    }

    fn drawn(&self, py: Python<'_>, draw: fn(&AnyPlan, &str, &Self) -> String) -> PyResult<String> {
        let plan = self.solved()?;
        Ok(py.detach(|| draw(plan, &self.instance.get().title, self)))
    }

    fn violations(&self, plan: &AnyPlan) -> Vec<cohaul_planner::certify::Violation> {
        plan.violations(&self.document().instance, self.request.model)
    }
}

#[pymethods]
impl Planned {
    /// What the file of the instance is called.
    #[getter]
    fn title(&self) -> &str {
        &self.instance.get().title
    }

    /// The search.
    #[getter]
    fn planner(&self) -> &'static str {
        self.request.planner.name()
    }

    /// The outcome with its numbers, as a JSON object.
    fn json(&self) -> String {
        let reasons = report::reasons(&self.answer, &self.document().instance);
        report::summary(&self.answer, &reasons, self.request.timeout).to_string()
    }

    /// Label and value of every row of the table of results.
    fn rows(&self) -> Vec<(&'static str, String)> {
        let reasons = report::reasons(&self.answer, &self.document().instance);
        report::rows(&self.answer, &reasons, self.request.timeout)
    }

    /// Cells (T, 2) of every agent with its name and the index of its goal; nothing for bodies that drive.
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Option<Routes<'py, i64>>> {
        let Outcome::Solved(AnyPlan::Grid(plan)) = &self.answer.outcome else { return Ok(None) };
        let routes = plan.routes.iter().map(|route| {
            let numbers = route.states.iter().flat_map(|cell| [i64::from(cell.x), i64::from(cell.y)]);
            Ok((route.name.clone(), route.goal, convert::column(py, [route.states.len(), 2], numbers)?))
        });
        routes.collect::<PyResult<_>>().map(Some)
    }

    /// Poses (T, 3) of every agent with its name and the index of its goal; nothing for agents on grids.
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Option<Routes<'py, f64>>> {
        let Outcome::Solved(AnyPlan::Car(plan)) = &self.answer.outcome else { return Ok(None) };
        let routes = plan.routes.iter().map(|route| {
            let numbers = route.states.iter().flat_map(|pose| {
                let at = se2::position(pose);
                [at.x, at.y, se2::yaw(pose)]
            });
            Ok((route.name.clone(), route.goal, convert::column(py, [route.states.len(), 3], numbers)?))
        });
        routes.collect::<PyResult<_>>().map(Some)
    }

    /// The plan in the layout of libMultiRobotPlanning; yaws turn as in the instance's file.
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        let plan = self.solved()?;
        let statistics = Statistics { effort: self.answer.effort, runtime: Some(self.answer.runtime) };
        Ok(py.detach(|| plan.to_text(self.document().heading, &statistics)))
    }

    /// The page that plays it.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        self.drawn(py, |plan, title, planned| plan.page(title, &planned.document().instance, &planned.violations(plan)))
    }

    /// The picture, SVG.
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        self.drawn(py, |plan, title, planned| {
            plan.picture(title, &planned.document().instance, &planned.violations(plan))
        })
    }

    /// What is wrong with it: a JSON list; against its own instance unless another one is given.
    #[pyo3(signature = (model, instance))]
    fn certify(&self, py: Python<'_>, model: &str, instance: Option<&Instance>) -> PyResult<String> {
        let (plan, model) = (self.solved()?, touching(model)?);
        let document = instance.map_or_else(|| self.document(), |instance| &instance.document);
        let listed = py.detach(|| {
            // as a file of its own: the other instance may be of another kind, or have other names
            if instance.is_some() {
                let text = plan.to_text(document.heading, &Statistics::default());
                let plan = AnyPlan::parse(&text, "plan", document)?;
                return Ok(report::violations(&plan.violations(&document.instance, model), &document.instance));
            }
            Ok(report::violations(&plan.violations(&document.instance, model), &document.instance))
        });
        Ok(listed.map_err(|e: FormatError| error::file(e.into()))?.to_string())
    }
}
