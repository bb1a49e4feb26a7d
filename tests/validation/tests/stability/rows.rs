//! T6 and T13: rows that are degenerate, and rows at borders.

use nalgebra::{DMatrix, Vector2, Vector3};
use ruga_constraint::{Degradation, Kernel, SampleConstraints, Sampling, constraint_rows};
use ruga_mesh::{MaterialPoint, TriMesh, VertexId, vertex_normals};
use ruga_stepper::{BendingModel, Modelling};
use ruga_validation::baselines::adjusted_as_printed;
use ruga_validation::{
    FilmCoupling, FilmSpec, Finding, Patch, Sheet, SheetSpec, Strip, equilateral, table_line,
};

use crate::{compress, draft, exact, patch, rows_alone, simulated, skin};

type Averages = Vec<Vec<(u32, f64)>>;

/// The three vertices nearest to the middle of a strip, on a line along it.
fn middle_vertices(strip: &Strip) -> [u32; 3] {
    let middle = Vector2::new(0.5 * strip.length, 0.5 * strip.width);
    let near =
        |v: u32, along: f64| (strip.points[v as usize] - middle - Vector2::x() * along).norm();
    let edge = strip.length / (4.0 * FilmSpec::POINTS);
    [-edge, 0.0, edge].map(|along| {
        let all = 0..strip.points.len() as u32;
        let nearest = all.min_by(|&a, &b| near(a, along).total_cmp(&near(b, along)));
        nearest.expect("a vertex")
    })
}

/// A film at twice the critical strain, with more averages than its coupling has.
fn held(strip: &Strip, averages: Averages) -> Sheet {
    let spec = FilmSpec::flat(150.0);
    let mut made = SheetSpec::film(&spec, strip);
    made.averages = averages;
    let mut sheet = Sheet::new(made);
    compress(&mut sheet, &spec, strip, 2.0);
    sheet.lie_down(Vector3::z(), 1e-3, 1);
    sheet
}

/// Number of averages less the rank of their matrix.
fn dependent(averages: &Averages, vertices: usize) -> usize {
    let mut matrix = DMatrix::zeros(averages.len(), vertices);
    for (row, average) in averages.iter().enumerate() {
        for &(vertex, weight) in average {
            matrix[(row, vertex as usize)] = weight;
        }
    }
    averages.len() - matrix.rank(1e-12)
}

#[test]
fn t6_degenerate_clusters() {
    let test = "T6 1, 2, 3 collinear vertices; duplicates";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(4.0, 8);
    let vertices = middle_vertices(&strip);
    let mean = |n: usize| -> Vec<(u32, f64)> {
        let share = 1.0 / n as f64;
        vertices[..n].iter().map(|&v| (v, share)).collect()
    };
    let alone = |i: usize| vec![(vertices[i], 1.0)];
    let averages = vec![mean(1), mean(2), mean(3), mean(3), alone(1), alone(2)];
    let spare = dependent(&averages, strip.points.len());
    assert_eq!(spare, 3);
    let numbers = format!("{spare} of 6 rows dependent: the KKT matrix is singular");
    table_line(test, "papers: plain KKT", Finding::Fails, &numbers);

    let mut sheet = held(&strip, averages);
    let solve = sheet.solve(&exact());
    assert!(solve.converged && solve.infeasibility < 1e-9, "{solve:?}");
    assert!(solve.inertia.is_some_and(|inertia| inertia.is_minimum()));
    assert!(sheet.amplitude(&Vector3::z(), |_| true) > 0.8 * spec.film.thickness);
    // The rows' own crate names what cannot be affine, and leaves out what it has had.
    let mesh = TriMesh::new(strip.points.len(), strip.faces.clone()).expect("a mesh");
    let rest = strip.compressed(0.0);
    let place = MaterialPoint::of_vertex(&mesh, VertexId(vertices[1])).expect("a face");
    let narrow = Kernel {
        sigma: 1e-2 * strip.width,
        cut: 2.0,
    };
    let normals = vertex_normals(&mesh, &rest);
    let sampled = |sampling| {
        let set = constraint_rows(&mesh, &rest, &normals, &[place; 2], &[narrow; 2], sampling);
        let set = set.expect("rows");
        assert_eq!(set.duplicates, [1]);
        set.degraded
    };
    assert_eq!(sampled(Sampling::Adjusted), [(0, Degradation::FewVertices)]);
    assert_eq!(sampled(Sampling::Quadrature), []);
    let numbers = format!(
        "converges in {} steps; duplicates dropped, order lowered if adjusted; quadrature (the default) keeps it",
        solve.iterations
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}

#[test]
fn t6_as_many_clusters_as_vertices() {
    let test = "T6 clusters for vertices";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(4.0, 8);
    let count = strip.points.len();
    let mut sheet = held(&strip, (0..count as u32).map(|v| vec![(v, 1.0)]).collect());
    let solve = sheet.solve(&exact());
    assert!(solve.converged);
    assert!(sheet.amplitude(&Vector3::z(), |_| true) < 1e-9 * spec.film.thickness);
    let numbers = "a row for every vertex (RK table 1, row 3) leaves no room to wrinkle: flat";
    table_line(test, "papers", Finding::Fails, numbers);

    let layer = &simulated(&patch(0.12), &skin(), &draft(), 1).layers[0];
    let share = layer.constraints as f64 / layer.vertices as f64;
    assert!(share < 1.0 / 6.0, "{share}");
    let numbers = format!("spacing of 1.5 lam: {share:.3} clusters a vertex");
    table_line(test, "ruga", Finding::Holds, &numbers);
}

/// A sheet with free sides and a hole, and beside it another that it does not touch.
struct Bordered {
    strip: Strip,
    /// Width of the first piece, m.
    width: f64,
    wavelength: f64,
}

impl Bordered {
    /// Radius of the hole in wavelengths.
    const HOLE: f64 = 0.4;

    fn new(spec: &FilmSpec) -> Self {
        let wavelength = spec.theory().wavelength;
        let whole = spec.strip(5.0, 34);
        let centre = Vector2::new(0.5 * whole.length, 0.5 * whole.width);
        let is_kept =
            |&v: &u32| (whole.points[v as usize] - centre).norm() > Self::HOLE * wavelength;
        let faces: Vec<[u32; 3]> = whole
            .faces
            .iter()
            .copied()
            .filter(|f| f.iter().any(is_kept))
            .collect();
        let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let number = |v: u32| used.binary_search(&v).expect("a vertex in use") as u32;
        let mut strip = Strip {
            points: used.iter().map(|&v| whole.points[v as usize]).collect(),
            faces: faces.iter().map(|f| f.map(number)).collect(),
            ..whole.clone()
        };
        let other = equilateral(whole.length, 60, 10);
        let (shift, gap) = (strip.points.len() as u32, whole.width + wavelength);
        let beside = other.points.iter().map(|p| p + Vector2::y() * gap);
        strip.points.extend(beside);
        strip
            .faces
            .extend(other.faces.iter().map(|f| f.map(|v| v + shift)));
        strip.width = gap + other.width;
        Self {
            strip,
            width: whole.width,
            wavelength,
        }
    }

    /// Amplitudes at both free sides, the hole, and the other piece, over that of the interior.
    fn flares(&self, spec: &FilmSpec, load: f64) -> [f64; 4] {
        let made = SheetSpec::film(spec, &self.strip).with_free_sides();
        let mut sheet = Sheet::new(made);
        compress(&mut sheet, spec, &self.strip, 1.08);
        sheet.lie_down(Vector3::z(), 1e-3, 1);
        sheet.solve(&exact());
        compress(&mut sheet, spec, &self.strip, load);
        assert!(sheet.solve(&exact()).converged);
        // Whole waves about the middle, where the pinned ends are far.
        let height = |place: &dyn Fn(f64, f64) -> bool| {
            let from_hole =
                |p: &Vector3<f64>| p.x.hypot(p.y - 0.5 * self.width) / self.wavelength - Self::HOLE;
            sheet.amplitude(&Vector3::z(), |p| {
                p.x.abs() < 1.5 * self.wavelength && place(p.y / self.wavelength, from_hole(p))
            })
        };
        let (width, half) = (self.width / self.wavelength, 0.5);
        let interior = height(&|y, hole| y > half && y < width - half && hole > half);
        let near = [
            height(&|y, _| y < half),
            height(&|y, _| y > width - half && y < width + 1e-9),
            height(&|_, hole| hole < half),
            height(&|y, _| y > width + half),
        ];
        near.map(|near| near / interior)
    }

    /// Sums of rows around places on the free side, least and largest, and the least weight.
    fn clipped(&self, sample: SampleConstraints) -> [f64; 3] {
        let mesh = TriMesh::new(self.strip.points.len(), self.strip.faces.clone());
        let mesh = mesh.expect("a mesh");
        let rest = self.strip.compressed(0.0);
        let on_side = (0..).zip(&self.strip.points).filter(|(_, p)| p.y < 1e-12);
        let places = on_side.filter_map(|(v, _)| MaterialPoint::of_vertex(&mesh, VertexId(v)));
        let places: Vec<_> = places.collect();
        let kernels = vec![Kernel::alone(self.wavelength); places.len()];
        let normals = vertex_normals(&mesh, &rest);
        let set = sample(
            &mesh,
            &rest,
            &normals,
            &places,
            &kernels,
            Sampling::Quadrature,
        );
        let set = set.expect("rows");
        set.rows
            .iter()
            .fold([f64::MAX, 0.0, f64::MAX], |[low, high, least], row| {
                let weights = row.weights.iter().map(|pair| pair.1);
                let sum: f64 = weights.clone().sum();
                [low.min(sum), high.max(sum), weights.fold(least, f64::min)]
            })
    }
}

#[test]
fn t13_borders() {
    let test = "T13 free sides, a hole, two pieces";
    let spec = FilmSpec::flat(150.0);
    let sheet = Bordered::new(&spec);
    let [low, high, least] = sheet.clipped(adjusted_as_printed);
    assert!(high < 0.7 && least < 0.0, "{low} {high} {least}");
    let numbers = format!("rows at the side sum to {low:.2}..{high:.2}, with negative weights");
    table_line(
        test,
        "papers: adjustment as printed",
        Finding::Fails,
        &numbers,
    );
    let [low, high, least] = sheet.clipped(constraint_rows);
    assert!(low > 1.0 - 1e-12 && high < 1.0 + 1e-12 && least > 0.0);

    let told = |[low, high, hole, other]: [f64; 4]| {
        format!(
            "A over the interior's: sides {low:.2} {high:.2}, hole {hole:.2}, other piece {other:.2}"
        )
    };
    let flares = sheet.flares(&rows_alone(), 2.0);
    assert!(flares.iter().all(|flare| *flare < 1.2), "{flares:?}");
    table_line(
        test,
        "papers: rows alone, quadrature",
        Finding::Holds,
        &told(flares),
    );
    let flares = sheet.flares(&spec, 2.0);
    let [low, high, hole, other] = flares;
    assert!(low.max(high).max(hole).max(other) < 1.2, "{flares:?}");
    assert!((low / high - 1.0).abs() < 0.1, "{flares:?}");
    table_line(test, "ruga", Finding::Holds, &told(flares));
    let elastic = FilmSpec {
        coupling: FilmCoupling::Elastic,
        ..spec
    };
    let flares = sheet.flares(&elastic, 2.0);
    assert!(flares.iter().all(|flare| *flare < 1.8), "{flares:?}");
    table_line(
        test,
        "ruga: elastic, no rows",
        Finding::Bounded,
        &told(flares),
    );
}

/// A region's border is pinned, which stiffens what is narrow. Where hinges are corrected by what
/// their mesh responds with, that is taken for the triangles' doing; where curvature at vertices is,
/// only what is missing is made up for.
#[test]
fn t13_narrow_regions() {
    let ratio = |width: f64, bending: BendingModel| {
        let narrow = Patch {
            width,
            ..patch(0.12)
        };
        let modelling = Modelling { bending, ..draft() };
        let result = simulated(&narrow, &skin(), &modelling, 4);
        assert!(result.converged);
        result.layers[0].bending_ratio.expect("wrinkles")
    };
    let test = "T13 a narrow region";
    let [wide, narrow] = [0.04, 0.01].map(|width| ratio(width, BendingModel::Hinge));
    assert!((0.3..1.1).contains(&wide), "{wide}");
    assert!((1.3..=2.0).contains(&narrow), "{narrow}");
    let numbers = format!(
        "hinges corrected by {wide:.2} in a region 4 lam wide, by {narrow:.2} in one 1 lam wide"
    );
    table_line(test, "ruga: hinges", Finding::Fails, &numbers);
    let wide = ratio(0.04, BendingModel::VertexCurvature);
    assert!((0.8..1.1).contains(&wide), "{wide}");
    let numbers = format!(
        "made up for what is missing only; {wide:.2} of the material at 4 lam and 6 points"
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}
