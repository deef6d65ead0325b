//! The suite of point-to-polygon form factors made by an independent system.

#[test]
fn the_suite_is_whole() {
    let suite = include_str!("data/form-factor.jsonl");
    assert_eq!(suite.lines().count(), 1117);
}
