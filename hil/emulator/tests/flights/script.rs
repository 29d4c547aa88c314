//! Console sessions of a page: blocks marked `console`, in which a line after `> ` is typed and the lines below are the
//! answer. `…` stands for any text within a line, and alone for any lines.

/// A line at which any key is pressed; the command may print more before it than the page shows.
const ANY_KEY: &str = "(any key)";

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Typed {
    pub line: usize,
    pub command: String,
    pub answer: Vec<String>,
}

pub(super) fn typed(page: &str) -> Vec<Typed> {
    let mut script = Vec::<Typed>::new();
    let mut inside = false;
    for (number, line) in (1..).zip(page.lines()) {
        // A block may be indented in a list.
        let text = line.trim();
        if text.starts_with("```") {
            inside = text == "```console";
        } else if inside && let Some(command) = text.strip_prefix("> ") {
            script.push(Typed {
                line: number,
                command: command.to_owned(),
                answer: Vec::new(),
            });
        } else if inside && let Some(step) = script.last_mut() {
            step.answer.push(text.to_owned());
        }
    }
    script
}

impl Typed {
    pub fn restarts(&self) -> bool {
        self.answer
            .last()
            .is_some_and(|line| line.ends_with("restarting"))
    }

    /// The texts after which any key is pressed, in order: where one ends the command or at [`ANY_KEY`].
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        let before = std::iter::once("").chain(self.answer.iter().map(String::as_str));
        before
            .zip(&self.answer)
            .filter_map(|(before, line)| match line.as_str() {
                ANY_KEY => Some(longest(before)),
                _ if line.ends_with("any key ends it") => Some(longest(line)),
                _ => None,
            })
    }
}

fn longest(pattern: &str) -> &str {
    let parts = pattern.split('…').map(str::trim);
    parts.max_by_key(|part| part.len()).unwrap_or_default()
}

/// Difference between `said` (command echo to next prompt) and the page's answer; `None` if equal.
pub(super) fn differs(step: &Typed, said: &str) -> Option<String> {
    let echoed = said.split_once(&step.command).map_or(said, |(_, rest)| rest);
    let lines: Vec<&str> = echoed.lines().map(str::trim).collect();
    let lines: Vec<&str> = lines
        .into_iter()
        .filter(|line| !matches!(*line, "" | ">"))
        .collect();
    let same = fit(&lines, &step.answer);
    (!same).then(|| {
        let (wanted, lines) = (step.answer.join("\n  "), lines.join("\n  "));
        format!("'{}' is answered\n  {lines}\nand not\n  {wanted}", step.command)
    })
}

fn fit(lines: &[&str], answer: &[String]) -> bool {
    let Some((pattern, rest)) = answer.split_first() else {
        return lines.is_empty();
    };
    if matches!(pattern.as_str(), "…" | ANY_KEY) {
        return (0..=lines.len()).any(|skipped| fit(&lines[skipped..], rest));
    }
    lines
        .split_first()
        .is_some_and(|(line, lines)| fits(line, pattern) && fit(lines, rest))
}

/// Runs of blanks count as one.
fn fits(line: &str, pattern: &str) -> bool {
    let single = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (line, pattern) = (single(line), single(pattern));
    let mut parts = pattern.split('…');
    let Some(mut rest) = line.strip_prefix(parts.next().unwrap_or_default()) else {
        return false;
    };
    let mut last = None;
    for part in parts {
        let Some((_, after)) = rest.split_once(part) else {
            return false;
        };
        (rest, last) = (after, Some(part));
    }
    match last {
        None => rest.is_empty(),
        Some(part) => line.ends_with(part),
    }
}

#[test]
fn a_page_is_read_and_its_answers_compared() {
    let page = "text\n> quoted\n```console\n> status\nDISARMED\nbattery … V, 0.0 A\n> get x\n  x 1\n```\n\
                - item\n\n  ```console\n  > save\n  saved; restarting\n  ```\n```\n> not typed\n```\n";
    let script = typed(page);
    let commands: Vec<_> = script
        .iter()
        .map(|step| (step.line, step.command.as_str()))
        .collect();
    assert_eq!(commands, [(4, "status"), (7, "get x"), (13, "save")]);
    let right = "\r\n> \r\n> status\r\nDISARMED\r\nbattery 16.20 V, 0.0 A\r\n> ";
    assert_eq!(differs(&script[0], right), None);
    for wrong in [
        "status\r\nDISARMED: radio lost\r\nbattery 16.20 V, 0.0 A\r\n> ",
        "status\r\nDISARMED\r\nbattery 16.20 V, 0.0 A, more\r\n> ",
        "status\r\nDISARMED\r\n> ",
        "status\r\nDISARMED\r\nbattery 16.20 V, 0.0 A\r\nmore\r\n> ",
        "status\r\n> ",
    ] {
        assert!(differs(&script[0], wrong).is_some(), "{wrong}");
    }
    assert_eq!(differs(&script[1], "get x\r\n  x       1\r\n> "), None);
    assert!(differs(&script[1], "get x\r\n  x       12\r\n> ").is_some());
    assert_eq!(script[0].keys().count(), 0);
}

#[test]
fn keys_are_pressed_where_the_answer_asks_for_them() {
    let page = "```console\n> watch imu\nroll az\n… -9.…\n(any key)\n\
                > servo 1\nservo 1 to 9 us; any key ends it\nback\n```\n";
    let script = typed(page);
    assert_eq!(script[0].keys().collect::<Vec<_>>(), ["-9."]);
    assert_eq!(
        script[1].keys().collect::<Vec<_>>(),
        ["servo 1 to 9 us; any key ends it"]
    );
    let rows = "watch imu\r\n roll   az\r\n 0.1 -9.81\r\n 0.2 -9.80\r\n> ";
    assert_eq!(differs(&script[0], rows), None);
    assert!(differs(&script[0], "watch imu\r\n roll   az\r\n 0.1 -8.81\r\n> ").is_some());
}
