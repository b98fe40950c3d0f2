//! Drawing area of a chart: axes with their grid, and marks in SVG above what is drawn.

use plotters::{
    coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
    prelude::*,
};

use crate::summary::digits;

/// Layout of a chart.
pub struct Canvas<'a> {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Margin above the chart, pixels.
    pub above: i32,
    /// Margin to the right of the chart, pixels.
    pub right: i32,
    /// Titles of the horizontal and of the vertical axis.
    pub titles: [&'a str; 2],
    /// Gray levels of the fine and of the bold lines of the grid.
    pub grid: [u8; 2],
    /// Label of a value on the horizontal axis.
    pub x_label: &'a dyn Fn(&f64) -> String,
}

/// Message of plotters as text.
pub fn said(error: impl std::fmt::Display) -> String {
    format!("the chart cannot be drawn: {error}")
}

impl Canvas<'_> {
    /// Draws a chart as SVG; `draw` adds its curves, and returns marks in SVG that are laid over them.
    ///
    /// # Errors
    /// Message of the drawing library.
    pub fn svg<X, Y>(
        &self,
        x: impl AsRangedCoord<CoordDescType = X, Value = f64>,
        y: impl AsRangedCoord<CoordDescType = Y, Value = f64>,
        draw: impl FnOnce(
            &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>,
        ) -> Result<String, String>,
    ) -> Result<String, String>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let mut svg = String::new();
        let marks = {
            let root = SVGBackend::with_string(&mut svg, self.size).into_drawing_area();
            root.fill(&WHITE).map_err(said)?;
            let mut chart = ChartBuilder::on(&root)
                .margin(14)
                .margin_top(self.above)
                .margin_right(self.right)
                .x_label_area_size(44)
                .y_label_area_size(74)
                .build_cartesian_2d(x, y)
                .map_err(said)?;
            let [fine, bold] = self.grid.map(|gray| RGBColor(gray, gray, gray));
            chart
                .configure_mesh()
                .x_desc(self.titles[0])
                .y_desc(self.titles[1])
                .x_label_formatter(&self.x_label)
                .y_label_formatter(&|value| digits(*value))
                .light_line_style(fine)
                .bold_line_style(bold)
                .label_style(("sans-serif", 13))
                .axis_desc_style(("sans-serif", 14))
                .draw()
                .map_err(said)?;
            let marks = draw(&mut chart)?;
            root.present().map_err(said)?;
            marks
        };
        let end = svg.rfind("</svg>").ok_or_else(|| said("it has no end"))?;
        svg.insert_str(end, &marks);
        Ok(svg)
    }
}
