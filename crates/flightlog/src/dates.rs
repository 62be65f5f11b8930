//! Times written as dates: `2023-04-18T16:49:57.5Z`, `18/04/2023 16:49:57`, with or without a zone; and as messages show
//! them.

use glidepolar_dbd::days_since_1970;

/// What stands first in a date of numbers whose year is last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DateOrder {
    /// `18/04/2023`.
    DayFirst,
    /// `04/18/2023`.
    MonthFirst,
}

impl DateOrder {
    /// The order as a user states it by `--unit time_s=`.
    pub(super) fn parse(text: &str) -> Option<Self> {
        match text.trim().to_lowercase().as_str() {
            "day-first" | "dmy" => Some(DateOrder::DayFirst),
            "month-first" | "mdy" => Some(DateOrder::MonthFirst),
            _ => None,
        }
    }
}

/// What a date shows of its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shows {
    /// One of its numbers is no month.
    Order(DateOrder),
    /// Either order is possible, and they are two days.
    Either,
    /// No date of this kind, or the same day in either order.
    Nothing,
}

/// What the date in a text shows of the order of day and month. Points stand between day, month and year where the day is first.
pub(super) fn shows_order(text: &str) -> Shows {
    if !has_year_last(text) {
        return Shows::Nothing;
    }
    let mut parts = text.trim().split(['-', '/']).map(str::parse::<u32>);
    match (parts.next(), parts.next()) {
        (Some(Ok(13..=31)), Some(Ok(1..=12))) => Shows::Order(DateOrder::DayFirst),
        (Some(Ok(1..=12)), Some(Ok(13..=31))) => Shows::Order(DateOrder::MonthFirst),
        (Some(Ok(a @ 1..=12)), Some(Ok(b @ 1..=12))) if a != b => Shows::Either,
        _ => Shows::Nothing,
    }
}

/// Whether the date in a text is of numbers and has its year last.
pub(super) fn has_year_last(text: &str) -> bool {
    let date = text.trim().split(['T', 't', ' ']).next().unwrap_or("");
    let parts: Vec<&str> = date.split(['-', '/']).collect();
    let is_number = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    parts.len() == 3 && parts.iter().all(is_number) && parts[0].len() <= 2 && parts[2].len() == 4
}

/// Unix time of a date, in UTC unless it states a zone, the day before the month \[s\]; nothing of a text that is none.
pub(super) fn unix_s(text: &str) -> Option<f64> {
    ordered_unix_s(text, DateOrder::DayFirst)
}

/// The same, with day and month in this order where the year is last.
pub(super) fn ordered_unix_s(text: &str, order: DateOrder) -> Option<f64> {
    of_years(text, 1900..3000, order)
}

/// The same for the day from which a file counts its times, which may lie before any glider: year 0, 1858, 1900.
pub(super) fn epoch_s(text: &str) -> Option<f64> {
    of_years(text, 0..3000, DateOrder::DayFirst)
}

/// A time above this counts from 1970, not from the start of a mission: three years.
pub(super) const FIRST_UNIX_S: f64 = 1e8;

/// A time as messages show it: `2023-04-18 16:49:57 UTC`, or `1234 s` where it counts from a start of its own.
pub fn shown_time(time_s: f64) -> String {
    if time_s.is_nan() || time_s <= FIRST_UNIX_S {
        return format!("{time_s:.0} s");
    }
    let seconds = time_s.round() as i64;
    let (mut days, clock) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    // The last first of January, then the last first day of a month, that is not after the day.
    let mut year = 1970 + days / 366;
    while days_since_1970(year + 1, 1, 1) <= days {
        year += 1;
    }
    let month = (1..=12).rev().find(|&month| days_since_1970(year, month, 1) <= days).unwrap_or(1);
    days -= days_since_1970(year, month, 1);
    let (hour, minute, second) = (clock / 3600, clock / 60 % 60, clock % 60);
    format!("{year}-{month:02}-{:02} {hour:02}:{minute:02}:{second:02} UTC", days + 1)
}

fn of_years(text: &str, years: std::ops::Range<i64>, order: DateOrder) -> Option<f64> {
    let text = text.trim();
    let (date, clock) = match text.find(['T', 't', ' ']) {
        Some(at) => (&text[..at], text[at + 1..].trim()),
        None => (text, ""),
    };
    let (year, month, day) = date_of(date, order)?;
    let (clock, zone_s) = without_zone(clock)?;
    let (clock, half_h) = without_half(clock);
    // Without colons: `164957`.
    let is_compact = clock.len() == 6 && clock.bytes().all(|digit| digit.is_ascii_digit());
    let with_colons =
        if is_compact { format!("{}:{}:{}", &clock[..2], &clock[2..4], &clock[4..]) } else { clock.to_owned() };
    let clock = with_colons.as_str();
    let mut parts = clock.split(':');
    let mut number = |most: f64| -> Option<f64> {
        match parts.next() {
            None | Some("") => Some(0.0),
            // A decimal comma is allowed by ISO 8601.
            Some(part) => part
                .replace(',', ".")
                .parse()
                .ok()
                .filter(|value: &f64| (0.0..=most).contains(value) && !part.starts_with('+')),
        }
    };
    let (hour, minute, second) = (number(24.0)?, number(59.0)?, number(60.999_999)?);
    if parts.next().is_some() {
        return None;
    }
    if !years.contains(&year) || !(1..=12).contains(&month) || !(1..=days_of(year, month)).contains(&day) {
        return None;
    }
    let hour = match half_h {
        None => hour,
        Some(half_h) if (1.0..13.0).contains(&hour) => hour % 12.0 + half_h,
        Some(_) => return None,
    };
    let days = days_since_1970(year, month, day);
    Some(days as f64 * 86_400.0 + hour * 3600.0 + minute * 60.0 + second - zone_s)
}

/// How many days a month has.
fn days_of(year: i64, month: i64) -> i64 {
    let (next_year, next_month) = if month == 12 { (year + 1, 1) } else { (year, month + 1) };
    days_since_1970(next_year, next_month, 1) - days_since_1970(year, month, 1)
}

/// `2023-04-18`, `2023/04/18`, `20230418`, `18.04.2023`, `18-Apr-2023`, or in the order of the file `18/04/2023`.
fn date_of(text: &str, order: DateOrder) -> Option<(i64, i64, i64)> {
    const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    if text.len() == 8 && text.bytes().all(|digit| digit.is_ascii_digit()) {
        return Some((text[..4].parse().ok()?, text[4..6].parse().ok()?, text[6..].parse().ok()?));
    }
    let parts: Vec<&str> = text.split(['-', '/', '.']).collect();
    let [a, b, c] = parts[..] else { return None };
    let number = |text: &str| text.bytes().all(|digit| digit.is_ascii_digit()).then(|| text.parse::<i64>().ok())?;
    let named = MONTHS.iter().position(|month| b.eq_ignore_ascii_case(month));
    if let (Some(month), 1 | 2, 4) = (named, a.len(), c.len()) {
        return Some((number(c)?, month as i64 + 1, number(a)?));
    }
    match (a.len(), c.len()) {
        (4, 1 | 2) => Some((number(a)?, number(b)?, number(c)?)),
        (1 | 2, 4) if order == DateOrder::MonthFirst && !text.contains('.') => {
            Some((number(c)?, number(a)?, number(b)?))
        }
        (1 | 2, 4) => Some((number(c)?, number(b)?, number(a)?)),
        _ => None,
    }
}

/// The clock without `AM` or `PM`, and the hour from which that half of the day counts: spreadsheets write so.
fn without_half(clock: &str) -> (&str, Option<f64>) {
    let half = |ending: &str| {
        let at = clock.len().checked_sub(ending.len())?;
        clock.get(at..).filter(|end| end.eq_ignore_ascii_case(ending)).map(|_| clock[..at].trim_end())
    };
    match (half("am"), half("pm")) {
        (Some(clock), _) => (clock, Some(0.0)),
        (_, Some(clock)) => (clock, Some(12.0)),
        _ => (clock, None),
    }
}

/// The clock without `Z` or `+02:00`, and the seconds by which that zone is ahead.
fn without_zone(clock: &str) -> Option<(&str, f64)> {
    let clock = ["UTC", "utc", "GMT", "gmt"].iter().fold(clock, |clock, zone| clock.trim_end_matches(zone)).trim_end();
    if let Some(clock) = clock.strip_suffix(['Z', 'z']) {
        return Some((clock, 0.0));
    }
    let Some(at) = clock.rfind(['+', '-']) else { return Some((clock, 0.0)) };
    let sign = if clock.as_bytes()[at] == b'+' { 1.0 } else { -1.0 };
    let digits: String = clock[at + 1..].chars().filter(|c| *c != ':').collect();
    let hours: f64 = digits.get(..2)?.parse().ok()?;
    let minutes: f64 = if digits.len() > 2 { digits.get(2..4)?.parse().ok()? } else { 0.0 };
    Some((clock[..at].trim(), sign * (hours * 3600.0 + minutes * 60.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_shown_as_dates_that_read_back() {
        assert_eq!(shown_time(1_681_836_597.4), "2023-04-18 16:49:57 UTC");
        assert_eq!(shown_time(1234.0), "1234 s");
        for day in 0..3000 {
            let time_s = 1.5e9 + 86_400.0 * f64::from(day);
            assert_eq!(unix_s(&shown_time(time_s)), Some(time_s), "{}", shown_time(time_s));
        }
    }

    #[test]
    fn dates_are_unix_times() {
        // 2023-04-18T16:49:57Z by `date -u +%s`.
        for text in [
            "2023-04-18T16:49:57Z",
            "2023-04-18 16:49:57",
            "18/04/2023 16:49:57",
            "2023-04-18T18:49:57+02:00",
            "2023-04-18T16:49:57.000000000",
            "20230418T164957Z",
            "18-Apr-2023 16:49:57",
            "2023-04-18 16:49:57 GMT",
            "18/04/2023 04:49:57 PM",
            "18/04/2023 4:49:57pm",
        ] {
            assert_eq!(unix_s(text), Some(1_681_836_597.0), "{text}");
        }
        assert_eq!(unix_s("1970-01-01"), Some(0.0));
        for (text, hour) in [("12:30:00 AM", 0.5), ("12:30:00 PM", 12.5), ("1:00 AM", 1.0), ("11:00:00 PM", 23.0)] {
            assert_eq!(unix_s(&format!("1970-01-01 {text}")), Some(3600.0 * hour), "{text}");
        }
        assert_eq!((unix_s("0000-01-01"), epoch_s("0000-01-01")), (None, Some(-719_528.0 * 86_400.0)));
        assert_eq!(unix_s("22/07/2019 05:24:38.427").map(|t| (t * 1e3).round()), Some(1_563_773_078_427.0));
        for text in [
            "",
            "12.5",
            "2023-13-01",
            "2023-04-18T25:00:00",
            "yesterday",
            "1.2.3",
            "2023-04-18T16:49:57:1",
            "18/04/2023 16:49:57 PM",
        ] {
            assert_eq!(unix_s(text), None, "{text}");
        }
    }

    #[test]
    fn a_day_that_the_month_has_not_is_no_date() {
        for text in ["2023-02-30", "2023-02-29", "31/04/2023", "2100-02-29", "2024-06-31T12:00:00Z"] {
            assert_eq!(unix_s(text), None, "{text}");
        }
        for text in ["2024-02-29", "2000-02-29", "31/12/2023"] {
            assert!(unix_s(text).is_some(), "{text}");
        }
    }

    #[test]
    fn the_order_of_day_and_month_shows_where_one_of_them_is_no_month() {
        for (text, shown) in [
            ("18/04/2023 16:49:57", Shows::Order(DateOrder::DayFirst)),
            ("04/18/2023 16:49:57", Shows::Order(DateOrder::MonthFirst)),
            ("4-18-2023", Shows::Order(DateOrder::MonthFirst)),
            ("05/06/2024", Shows::Either),
            ("05/05/2024", Shows::Nothing),
            ("05.06.2024", Shows::Nothing),
            ("2024-05-06T00:00:00Z", Shows::Nothing),
            ("1717545600", Shows::Nothing),
        ] {
            assert_eq!(shows_order(text), shown, "{text}");
        }
        assert_eq!(ordered_unix_s("05/06/2024", DateOrder::MonthFirst), unix_s("2024-05-06"));
        assert_eq!(ordered_unix_s("05.06.2024", DateOrder::MonthFirst), unix_s("2024-06-05"));
        assert_eq!(ordered_unix_s("05/06/2024", DateOrder::DayFirst), unix_s("2024-06-05"));
    }
}
