//! Sparse matrices row by row.

use clarabel::algebra::CscMatrix;

/// Rows of a sparse matrix with their right sides.
pub(in crate::cam::tune) struct Rows {
    columns: Vec<Vec<(usize, f64)>>,
    right: Vec<f64>,
}

impl Rows {
    pub(in crate::cam::tune) fn new(columns: usize) -> Self {
        Self { columns: vec![Vec::new(); columns], right: Vec::new() }
    }

    pub(in crate::cam::tune) fn count(&self) -> usize {
        self.right.len()
    }

    pub(in crate::cam::tune) fn add(
        &mut self,
        entries: impl Iterator<Item = (usize, f64)>,
        right: f64,
    ) {
        let row = self.right.len();
        for (column, value) in entries {
            if let Some(column) = self.columns.get_mut(column) {
                column.push((row, value));
            }
        }
        self.right.push(right);
    }

    pub(in crate::cam::tune) fn into_matrix(self) -> (CscMatrix<f64>, Vec<f64>) {
        let rows = self.right.len();
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in &self.columns {
            for (row, value) in column {
                indices.push(*row);
                values.push(*value);
            }
            starts.push(values.len());
        }
        (CscMatrix::new(rows, self.columns.len(), starts, indices, values), self.right)
    }
}
