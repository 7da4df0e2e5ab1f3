//! Where the sun stands, by place and time.

use glam::DVec3;
use std::f64::consts::TAU;

/// A place on the Earth and a time there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Latitude, radians, positive in the north.
    pub latitude: f64,
    /// Longitude, radians, positive in the east.
    pub longitude: f64,
    /// Hours that the clock is ahead of universal time.
    pub timezone: f64,
    /// Year.
    pub year: i32,
    /// Month, from 1.
    pub month: u32,
    /// Day of the month, from 1.
    pub day: u32,
    /// Hours since midnight, with their fraction.
    pub hour: f64,
}

/// The direction towards the sun [Blanco-Muriel et al. 2001, "Computing the solar vector", table 2], good to a hundredth of a
/// degree between 1999 and 2015: +y is up, -z in the north and +x in the east.
pub fn sun_direction(moment: &Moment) -> DVec3 {
    let hour = moment.hour - moment.timezone;
    // Days since noon of the first of January 2000, universal time.
    let days = days_since_2000(moment.year, moment.month, moment.day) + hour / 24.0 - 0.5;

    // Ecliptic coordinates.
    let omega = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * days;
    let mean_anomaly = 6.240_060_0 + 0.017_201_969_9 * days;
    let ecliptic_longitude =
        mean_longitude + 0.033_416_07 * mean_anomaly.sin() + 0.000_348_94 * (2.0 * mean_anomaly).sin()
            - 0.000_113_4
            - 0.000_020_3 * omega.sin();
    let obliquity = 0.409_092_8 - 6.2140e-9 * days + 0.000_039_6 * omega.cos();

    // Celestial coordinates.
    let (sin, cos) = ecliptic_longitude.sin_cos();
    let right_ascension = (obliquity.cos() * sin).atan2(cos);
    let declination = (obliquity.sin() * sin).asin();

    // Local coordinates.
    let sidereal = 6.697_424_324_2 + 0.065_709_828_3 * days + hour;
    let hour_angle = sidereal * TAU / 24.0 + moment.longitude - right_ascension;
    let (sin_latitude, cos_latitude) = moment.latitude.sin_cos();
    let (sin_declination, cos_declination) = declination.sin_cos();
    let up = cos_latitude * cos_declination * hour_angle.cos() + sin_latitude * sin_declination;
    let north = cos_latitude * sin_declination - sin_latitude * cos_declination * hour_angle.cos();
    let east = -cos_declination * hour_angle.sin();
    // The centre of the Earth sees it a little higher: its radius over the distance of the sun.
    const PARALLAX: f64 = 6371.01 / 149_597_890.0;
    DVec3::new(east, up - PARALLAX, -north).normalize()
}

/// Days from the first of January 2000 to a day of the Gregorian calendar.
fn days_since_2000(year: i32, month: u32, day: u32) -> f64 {
    // Years that begin in March end with the leap day.
    let (year, month) = if month < 3 { (f64::from(year) - 1.0, month + 9) } else { (f64::from(year), month - 3) };
    let leap_days = (year / 4.0).floor() - (year / 100.0).floor() + (year / 400.0).floor();
    // Months from March on have 31 and 30 days in turn, five at a time.
    let months = ((153 * month + 2) / 5) as f64;
    // The first of March of the year 0 lies 730 425 days before the first of January 2000.
    365.0 * year + leap_days + months + f64::from(day) - 1.0 - 730_425.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_over_leap_days() {
        for (date, days) in [
            ((2000, 1, 1), 0.0),
            ((2000, 2, 29), 59.0),
            ((2000, 3, 1), 60.0),
            ((2000, 12, 31), 365.0),
            ((2001, 1, 1), 366.0),
            ((1999, 12, 31), -1.0),
            ((2010, 7, 10), 3843.0),
            ((2100, 3, 1), 36584.0),
        ] {
            assert_eq!(days_since_2000(date.0, date.1, date.2), days, "{date:?}");
        }
    }
}
