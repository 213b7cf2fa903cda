//! A small evaluator of ONNX graphs for the operators that the exported models use, written from the specification and from
//! nothing else of this project.

use std::collections::HashMap;

use trainer::onnx::{ModelProto, NodeProto};

/// Numbers with a shape, row by row.
#[derive(Clone, Debug)]
pub struct Tensor {
    pub shape: Vec<usize>,
    pub numbers: Vec<f32>,
}

/// Runs a graph and returns one of its tensors.
pub fn evaluate(model: &ModelProto, inputs: Vec<(&str, Tensor)>, output: &str) -> Tensor {
    let graph = model.graph.as_ref().unwrap();
    let names: Vec<&str> = graph.input.iter().map(|input| input.name.as_str()).collect();
    assert_eq!(names, inputs.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    let mut known: HashMap<String, Tensor> =
        inputs.into_iter().map(|(name, tensor)| (name.to_owned(), tensor)).collect();
    let mut integers = HashMap::new();
    for constant in &graph.initializer {
        let shape = constant.dims.iter().map(|size| *size as usize).collect();
        match constant.floats() {
            Some(numbers) => drop(known.insert(constant.name.clone(), Tensor { shape, numbers })),
            None => drop(integers.insert(constant.name.clone(), constant.integers().unwrap())),
        }
    }
    for node in &graph.node {
        let result = operator(node, &known, &integers);
        assert!(known.insert(node.output[0].clone(), result).is_none(), "each tensor is written once");
    }
    known.remove(output).unwrap()
}

fn operator(
    node: &NodeProto,
    known: &HashMap<String, Tensor>,
    integers: &HashMap<String, Vec<i64>>,
) -> Tensor {
    let input = |index: usize| &known[&node.input[index]];
    let integer = |index: usize| &integers[&node.input[index]];
    match node.op_type.as_str() {
        "Sub" => elementwise(input(0), input(1), |a, b| a - b),
        "Div" => elementwise(input(0), input(1), |a, b| a / b),
        "Clip" => {
            let (low, high) = (input(1).numbers[0], input(2).numbers[0]);
            map(input(0), |x| x.clamp(low, high))
        }
        "Relu" => map(input(0), |x| x.max(0.0)),
        "MatMul" => product(input(0), input(1)),
        "Gemm" => elementwise(&product(input(0), input(1)), input(2), |a, b| a + b),
        "Reshape" => {
            let shape = integer(1).iter().map(|size| *size as usize).collect();
            Tensor { shape, numbers: input(0).numbers.clone() }
        }
        "Gather" => {
            assert_eq!((node.attribute[0].name.as_str(), node.attribute[0].i), ("axis", Some(0)));
            let (table, rows) = (input(0), integer(1));
            let width = table.shape[1];
            let row = |row: &i64| table.numbers[*row as usize * width..][..width].to_vec();
            Tensor { shape: vec![rows.len(), width], numbers: rows.iter().flat_map(row).collect() }
        }
        other => panic!("an operator of the exported models, not {other}"),
    }
}

fn map(x: &Tensor, f: impl Fn(f32) -> f32) -> Tensor {
    Tensor { shape: x.shape.clone(), numbers: x.numbers.iter().map(|x| f(*x)).collect() }
}

/// `b` is repeated for each row of `a`.
fn elementwise(a: &Tensor, b: &Tensor, f: impl Fn(f32, f32) -> f32) -> Tensor {
    assert_eq!(a.shape.last(), b.shape.last());
    assert_eq!(b.numbers.len(), *b.shape.last().unwrap(), "one row");
    let numbers = a.numbers.iter().zip(b.numbers.iter().cycle()).map(|(a, b)| f(*a, *b));
    Tensor { shape: a.shape.clone(), numbers: numbers.collect() }
}

/// The product of two matrices, summed in double precision.
fn product(a: &Tensor, b: &Tensor) -> Tensor {
    let (&[rows, inner], &[same, columns]) = (a.shape.as_slice(), b.shape.as_slice()) else {
        panic!("two matrices")
    };
    assert_eq!(inner, same);
    let mut numbers = Vec::with_capacity(rows * columns);
    for row in a.numbers.chunks_exact(inner) {
        let mut sums = vec![0.0_f64; columns];
        for (x, weights) in row.iter().zip(b.numbers.chunks_exact(columns)) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += f64::from(*x) * f64::from(*weight);
            }
        }
        numbers.extend(sums.iter().map(|sum| *sum as f32));
    }
    Tensor { shape: vec![rows, columns], numbers }
}
