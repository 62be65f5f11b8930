//! A program in Python that waits for its turns: started once, so that no interpreter's start is measured; every question
//! and every answer is one line of JSON.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// Longest time for an answer, unless set otherwise.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running peer.
pub struct Peer {
    name: String,
    child: Child,
    questions: ChildStdin,
    answers: Receiver<String>,
    patience: Duration,
}

impl Peer {
    /// Starts a script of benches/peers. Its first line says that it is ready.
    pub fn start(python: Option<&Path>, root: &Path, script: &str, arguments: &[&Path]) -> Result<Self> {
        let python = python.context("the Python environment with the other programs is not there")?;
        let mut child = Command::new(python)
            .arg(root.join("benches/peers").join(script))
            .args(arguments)
            .current_dir(root)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot start {script}"))?;
        let questions = child.stdin.take().context("no pipe")?;
        let (sender, answers) = channel();
        let output = BufReader::new(child.stdout.take().context("no pipe")?);
        std::thread::spawn(move || {
            // Other lines are the libraries' own chatter.
            for line in output.lines().map_while(Result::ok).filter(|line| line.starts_with('{')) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        let errors = child.stderr.take().context("no pipe")?;
        let complaints = std::thread::spawn(move || {
            let lines = BufReader::new(errors).lines().map_while(Result::ok);
            lines.fold(String::new(), |_, line| line)
        });
        let mut peer = Peer { name: script.to_owned(), child, questions, answers, patience: PATIENCE };
        match peer.answer() {
            Ok(_) => Ok(peer),
            Err(error) => {
                let _ = peer.child.kill();
                let _ = peer.child.wait();
                let last = complaints.join().unwrap_or_default();
                Err(if last.is_empty() { error } else { anyhow::anyhow!("{script}: {last}") })
            }
        }
    }

    /// With another longest time for an answer.
    pub fn patience(mut self, seconds: u64) -> Self {
        self.patience = Duration::from_secs(seconds);
        self
    }

    /// Asks and waits for the answer.
    pub fn ask(&mut self, question: &Value) -> Result<Value> {
        writeln!(self.questions, "{question}").and_then(|()| self.questions.flush()).context("the peer is gone")?;
        self.answer()
    }

    /// Asks for something whose answer holds `seconds`.
    pub fn seconds(&mut self, question: &Value) -> Result<f64> {
        number(&self.ask(question)?, "seconds")
    }

    fn answer(&mut self) -> Result<Value> {
        let line = match self.answers.recv_timeout(self.patience) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => bail!("{}: no answer within {:?}", self.name, self.patience),
            Err(RecvTimeoutError::Disconnected) => bail!("{} ended", self.name),
        };
        let answer: Value = serde_json::from_str(&line).with_context(|| format!("{}: {line}", self.name))?;
        match answer.get("error").and_then(Value::as_str) {
            Some(error) => bail!("{}: {error}", self.name),
            None => Ok(answer),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A number of an answer.
pub fn number(answer: &Value, key: &str) -> Result<f64> {
    answer.get(key).and_then(Value::as_f64).with_context(|| format!("no number `{key}` in {answer}"))
}
