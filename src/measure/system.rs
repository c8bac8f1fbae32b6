//! What the system says about this process.

/// The most memory this process has held at once, in bytes; `None` where the system does not tell (it does on Linux).
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_peak_covers_what_was_touched() {
        let block = std::hint::black_box(vec![1_u8; 32 << 20]);
        let peak = peak_rss_bytes().expect("Linux tells");
        assert!(peak > block.len() as u64 && peak < 1 << 40, "{peak}");
    }
}
