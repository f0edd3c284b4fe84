//! Sample times out of arrival times, a sensor's clock, and counters.
