//! The numbers of UDIM tiles in words.

use ruga_material::UvTile;

/// Tiles that are named one by one.
const NAMED: usize = 8;

/// `1001, 1002 and 1011`; of many the first few and the last.
pub(crate) fn tile_numbers(tiles: &[UvTile]) -> String {
    let mut numbers: Vec<String> = tiles.iter().map(|tile| tile.number().to_string()).collect();
    let Some(last) = numbers.pop() else {
        return String::new();
    };
    let joint = match numbers.len() {
        0 => return last,
        1..NAMED => " and ",
        _ => " ... ",
    };
    numbers.truncate(NAMED - 1);
    format!("{}{joint}{last}", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_are_named_one_by_one() {
        let tiles = |numbers: std::ops::Range<u32>| -> Vec<UvTile> {
            let tiles = numbers.map(|number| UvTile::from_number(number).expect("a tile"));
            tiles.collect()
        };
        assert_eq!(tile_numbers(&tiles(1002..1003)), "1002");
        assert_eq!(tile_numbers(&tiles(1001..1004)), "1001, 1002 and 1003");
        assert_eq!(
            tile_numbers(&tiles(1001..1031)),
            "1001, 1002, 1003, 1004, 1005, 1006, 1007 ... 1030"
        );
    }
}
